"""All pictures: of results, cases, gears, damage, lives; the HTML report."""
