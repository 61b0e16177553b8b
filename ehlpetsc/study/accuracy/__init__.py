"""Error against run time: which runs, their errors, the table and the picture."""
