"""Picture of a path of contact: load and pressure, radius, speeds."""


def draw(path, hertz, target, title):
    """Draw load, radius, speeds and slide/roll ratio along the line of action.

    Parameters
    ----------
    path : ehlpetsc.gears.path.Path
    hertz : tuple of ndarray or None
        Half width [m] and maximum pressure [Pa] along the path; None without moduli.
    target : path-like
        File of the picture.
    title : str
    """
    from matplotlib.figure import Figure

    position = 1e3 * (path.rho - path.pair.points["C"])
    figure = Figure(figsize=(7.0, 7.5), layout="constrained")
    load, radius, speed = figure.subplots(3, 1, sharex=True)
    load.plot(position, 1e-3 * path.load, color="#1f4e79")
    load.set_ylabel("load [kN/m]")
    load.set_ylim(bottom=0.0)
    if hertz is not None:
        pressure = load.twinx()
        pressure.plot(position, 1e-9 * hertz[1], color="#d62728")
        pressure.set_ylabel("Hertz pressure [GPa]", color="#d62728")
        pressure.set_ylim(bottom=0.0)
    radius.plot(position, 1e3 * path.radius, color="#1f4e79")
    radius.set_ylabel("radius of relative\ncurvature [mm]")
    for values, label, colour in (
        (path.speed_1, "flank 1 (pinion)", "#1f4e79"),
        (path.speed_2, "flank 2 (wheel)", "#e08214"),
        (path.speed_1 - path.speed_2, "sliding", "#7f7f7f"),
    ):
        speed.plot(position, values, label=label, color=colour)
    speed.set_ylabel("speed [m/s]")
    speed.set_xlabel("position on the line of action from the pitch point [mm]")
    speed.legend(fontsize=8)
    for axes in (load, radius, speed):
        axes.grid(alpha=0.3)
        for name, rho in path.pair.points.items():
            x = 1e3 * (rho - path.pair.points["C"])
            axes.axvline(x, color="0.7", linewidth=0.8)
            if axes is load:
                axes.annotate(name, (x, 1.01), xycoords=("data", "axes fraction"), ha="center")
    figure.suptitle(title, fontsize=10)
    figure.savefig(target, dpi=150)
