"""Cases of points and strips whose map is given as rows, as texts of TOML."""

ROWS = "[[0, 1e-8, 0, 2e-8, 1e-8], [1e-8, 0, 0, 1e-8, 0], [0, 0, 1e-8, 0, 0], [0, 1e-8, 0, 0, 0]]"
POINT = f"""
title = "a map given as rows"
contact = {{ radius = [0.01, 0.01], load = 10, material = "100Cr6", model = "mixed" }}
fluid = {{ oil = "fva3", temperature = 313.0 }}
mesh = {{ inlet = -2, outlet = 2, points_per_half_width = 8 }}
motion = {{ entrainment_speed = 1 }}
time = {{ travel = 1 }}
wear = {{ coefficient = 1e-17 }}
surface.1 = {{ z = {ROWS}, spacing = 1e-5 }}
"""
STRIP = POINT.replace("[0.01, 0.01], load = 10", "0.01, load = 1e5").replace(
    "outlet = 2", "outlet = 2, width = 0.5"
)
LAYER = STRIP.replace(
    '"mixed"', '"mixed", asperity_height = "measured", yield_pressure = "material"'
).replace("spacing = 1e-5", "spacing = 1e-5, short_cutoff = 2e-5, cutoff = 3e-5")
TABLE = "operation = { time = [0, 1e-4], load = [10, 20], speed_1 = [1, 1], speed_2 = [1, 1] }"
OPERATION = POINT.replace("load = 10, ", "").replace("motion = { entrainment_speed = 1 }", TABLE)
OPERATION = OPERATION.replace("time = { travel = 1 }\n", "").replace(
    'oil = "fva3"', 'grade = "ISO VG 100", law = "roelands", density = "dowson-higginson"'
)
PAIR = "gears = { module = 4.5e-3, teeth = [16, 24], profile_shift = [0.18, 0.17], face_width = 14e-3, "
PAIR += "torque = 302, speed = 2250 }"
GEARS = STRIP.replace("radius = 0.01, load = 1e5, ", "").replace("motion = { entrainment_speed = 1 }", PAIR)
GEARS = GEARS.replace("time = { travel = 1 }", 'heat = { bulk_temperature = "losses" }')
MAPS = {"point": POINT, "strip": STRIP, "layer": LAYER, "operation": OPERATION, "gears": GEARS}
