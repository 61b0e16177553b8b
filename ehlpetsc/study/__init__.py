"""Studies of the solver: table of extremes, error over run time, random cases."""
