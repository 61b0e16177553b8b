"""All pictures: of results, cases, gears, damage, lives; movies; the HTML report."""
