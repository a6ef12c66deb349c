"""What is wrong with a record before anything is judged: a fact a file, with its number, its limit and its remedy."""
