"""Values of a case derived from others: steels, oil grades, layers of profiles, conditions over time."""
