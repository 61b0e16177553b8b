"""What is read: the loads in a result file, and the case text stored in it."""
