"""Figures of one or several results, one function for each kind: `FIGURES`."""

from matplotlib.lines import Line2D

from ehlpetsc.pictures import frames, labels, over_time
from ehlpetsc.pictures.ensemble import draw_ensemble
from ehlpetsc.pictures.running_in import draw_running_in
from ehlpetsc.pictures.stribeck import draw_stribeck
from ehlpetsc.pictures.temperatures import temperatures
from ehlpetsc.pictures.traction import draw_traction

SIZE = (8.4, 5.6)  # inches
HEIGHT_WITH_SURFACES = 7.6  # inches
AROUND_WIDTH = 0.5  # half widths, of a view around a point


def two_panels():
    """Figure and axes of pressure above film."""
    return labels.new_figure(2, 1, SIZE, sharex=True)


def window(results, options):
    """Limits of x/a of the options, by default around the contact."""
    if options.around is None:
        return frames.default_window(results)
    half = 0.5 * (options.width or AROUND_WIDTH)
    return options.around - half, options.around + half


def panel_title(results, indices=None):
    """Common title of results, and the instant of stored frames."""
    titles = {result.attrs["title"] for result in results}
    texts = [titles.pop() if len(titles) == 1 else "", indices and frames.instant(results, indices)]
    return ": ".join(text for text in texts if text)


def fill_frame(axes, results, indices, options):
    """Draw pressure, film and their legends at an instant into axes."""
    colours, names, key = labels.series_colours(results)
    frames.pressure_and_film(axes, results, indices, colours, window(results, options))
    if len(results) > 1:
        hertz = Line2D([], [], color=frames.HERTZ_GREY, label="Hertz", **frames.HERTZ_STYLE)
        hertz_handles = [hertz] if labels.share_hertz_contact(results) else []
        dashed = len(results) == 2
        legend_title = labels.UNITS.get(key, key)
        names = labels.labels_with_hertz(names, results)
        labels.series_legend(axes[0], colours, names, legend_title, hertz_handles, dashed)
    else:
        frames.frame_legend(axes, results[0], indices[0], colours[0])
    frames.x_in_mm(axes[0], results)
    title = "\n".join(filter(None, [panel_title(results, indices), labels.conditions(results)]))
    axes[0].set_title(title, fontsize="medium")


def draw_frame(results, options):
    """Figure of pressure and film at an instant; for one rough result also of both deformed surfaces."""
    indices = frames.choose_frames(results, options.step, options.time)
    rough = len(results) == 1 and any(results[0].profile(side) for side in ("1", "2"))
    if not rough:
        figure, axes = two_panels()
    else:
        figure, axes = labels.new_figure(3, 1, (SIZE[0], HEIGHT_WITH_SURFACES), sharex=True)
        frames.deformed_surfaces(axes[2], results[0], indices[0], window(results, options))
    fill_frame(axes[:2], results, indices, options)
    if rough:
        axes[1].set_xlabel("")
        axes[2].set_xlabel(frames.ACROSS)
    return figure


def draw_map(results, options):
    """Figure of pressure over x and time, one panel for each result, with common colours."""
    size = (SIZE[0] * max(1.0, 0.6 * len(results)), SIZE[1])
    figure, axes = labels.new_figure(1, len(results), size, squeeze=False)
    views = [window([result], options) for result in results]
    highest = max(over_time.colour_limit([r], view) for r, view in zip(results, views, strict=True))
    _, names, key = labels.series_colours(results)
    titles = names if not key else [f"{key} = {name}" for name in names]
    for panel, result, view, title in zip(axes[0], results, views, titles, strict=True):
        image = over_time.space_time_map(panel, result, view, highest)
        panel.set_title(result.attrs["title"] if len(results) == 1 else title, fontsize="medium")
    figure.colorbar(image, ax=axes, label=frames.PRESSURE, extend="max")
    if any(result.contact_count.any() for result in results):
        mark = Line2D([], [], color=labels.CONTACT_COLOUR, marker="s", ls="", ms=4, label="in contact")
        axes[0][0].legend(handles=[mark], loc="upper left", fontsize="small")
    figure.suptitle(labels.conditions(results), fontsize="small")
    return figure


def draw_temperatures(results, options):
    """Figure of the temperatures of one result."""
    return temperatures(results, window(results, options), options)


FIGURES = {
    "map": draw_map,
    "stribeck": draw_stribeck,
    "traction": draw_traction,
    "temperatures": draw_temperatures,
    "ensemble": draw_ensemble,
    "running_in": draw_running_in,
}
