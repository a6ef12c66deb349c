"""Diagnosis by the filter of a diagram: where loads are not measured, the exact likelihood of a log is a Kalman filter's.

affine     each block as a straight line in its states and inputs      scanned   a diagram from one scan to the next
"""
