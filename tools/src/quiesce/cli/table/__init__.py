"""`quiesce table`: table files shown, checked, compared, stamped."""
