"""Error over run time: plan of the runs, errors, table and picture."""
