"""Random diagrams from a seed, simulated by the engine and judged by oracles outside it (python -m benchmarks.torture).

draw      a random diagram of a seed            oracle.c, c_program  the independent C program
judge     engine against oracles                __main__             the search and its figures
"""
