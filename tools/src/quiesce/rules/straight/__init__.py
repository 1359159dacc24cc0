"""Systems whose strengths and values are polynomials of the inputs, as straight-line C."""
