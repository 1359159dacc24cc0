"""Columns of records, for command lines that start without the libraries that read them."""

TIME, ACCEL = "t_s", "acc_m_s2"
