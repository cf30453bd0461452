"""NIST's reference problems of nonlinear regression (StRD), fitted by our own least squares."""
