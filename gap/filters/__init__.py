"""Diagnosis by the filter of a diagram: where loads are not measured, a Kalman filter gives the exact likelihood.

affine     each block as a straight line in its states and inputs      scanned   a diagram from one scan to the next
"""
