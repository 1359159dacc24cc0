"""Words that FCL and FIS files have for the norms of system/norms.py, by FuzzyLite's names."""

FCL_T_NORMS = {
    "MIN": "Minimum", "PROD": "AlgebraicProduct", "BDIF": "BoundedDifference",
    "DPROD": "DrasticProduct", "EPROD": "EinsteinProduct", "HPROD": "HamacherProduct",
    "NMIN": "NilpotentMinimum",
}  # fmt: skip
FCL_S_NORMS = {
    "MAX": "Maximum", "ASUM": "AlgebraicSum", "PROBOR": "AlgebraicSum", "BSUM": "BoundedSum",
    "DSUM": "DrasticSum", "ESUM": "EinsteinSum", "HSUM": "HamacherSum",
    "NMAX": "NilpotentMaximum", "NSUM": "NormalizedSum", "SUM": "UnboundedSum",
}  # fmt: skip
FIS_T_NORMS = {
    "min": "Minimum", "prod": "AlgebraicProduct", "bounded_difference": "BoundedDifference",
    "drastic_product": "DrasticProduct", "einstein_product": "EinsteinProduct",
    "hamacher_product": "HamacherProduct", "nilpotent_minimum": "NilpotentMinimum",
}  # fmt: skip
FIS_S_NORMS = {
    "max": "Maximum", "probor": "AlgebraicSum", "bounded_sum": "BoundedSum",
    "drastic_sum": "DrasticSum", "einstein_sum": "EinsteinSum", "hamacher_sum": "HamacherSum",
    "nilpotent_maximum": "NilpotentMaximum", "normalized_sum": "NormalizedSum",
    "sum": "UnboundedSum",
}  # fmt: skip
