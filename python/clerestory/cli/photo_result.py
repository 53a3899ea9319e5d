"""What `clerestory photo` prints of a developed series."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clerestory.cli.common import say, table

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from clerestory.photo import Developed


def for_machines(made: Developed, output: Path | None) -> dict[str, object]:
    """All that was found, for `--json`."""
    lens, vignetting, burnt = made.lens, made.vignetting, made.overflow
    return {
        "output": output,
        "size": list(made.picture.shape[::-1]),
        "view": None if made.picture.view is None else made.picture.view.options,
        "photographs": [
            {
                "file": p.path,
                "time_s": p.exposure.time,
                "f_number": p.exposure.f_number,
                "iso": p.exposure.iso,
                "camera": p.camera.model,
                "lens": p.camera.lens,
            }
            for p in made.series.photographs
        ],
        "steps": [
            {"shorter": s.shorter, "longer": s.longer, "given": s.given, "found": s.found, "spots": s.spots}
            for s in made.steps
        ],
        "response": {"method": made.response.method, "residual": made.response.residual},
        "lens": None
        if lens is None
        else {
            "projection": lens.projection or "table",
            "centre_px": list(lens.centre),
            "radius_px": lens.radius,
            "field_deg": 2.0 * lens.edge_deg,
            "found": None
            if made.circle is None
            else {"border_share": made.circle.share, "residual_px": made.circle.residual},
        },
        "vignetting": None
        if vignetting is None
        else {
            "coefficients": list(vignetting.coefficients),
            "table": [list(pair) for pair in vignetting.table],
            "residual": vignetting.residual,
            "reach_deg": vignetting.reach_deg,
        },
        "calibration": made.calibration,
        "factor": made.factor,
        "spots": [
            {
                "place": r.spot.words,
                "measured": r.spot.luminance,
                "picture": made.factor * r.mean,
                "pixels": r.pixels,
                "relative_spread": r.spread,
                "factor": r.factor,
            }
            for r in made.spots
        ],
        "illuminance": made.illuminance,
        "measured_illuminance": made.measured,
        "difference_percent": made.difference_percent,
        "acceptable": made.acceptable,
        "least_luminance": made.least,
        "greatest_luminance": made.most,
        "saturated_pixels": made.saturated_pixels,
        "overflow": None if burnt is None or burnt.solid_angle <= 0.0 else burnt,
        "dark_share": made.dark_share,
        "ghost_share": made.ghost_share,
        "assumptions": list(made.assumptions),
        "warnings": list(made.warnings),
    }


def for_people(made: Developed) -> None:
    """Print what was found."""
    from clerestory.plot.style import figures

    series = made.series.photographs
    rows = [
        [p.path.name, p.exposure.words, *(("", "") if s is None else (f"{s.given:.3g} ×", f"{s.found:.3g} ×"))]
        for p, s in zip(series, (None, *made.steps), strict=True)
    ]
    say(table(["photograph", "exposure", "step", "in light"], rows, left=2))
    line: Callable[[str, str], None] = lambda name, text: say(f"  {name:<12}{text}")  # noqa: E731 (one look)
    misfit = "" if made.response.residual is None else f", misfit {100.0 * made.response.residual:.1f} %"
    line("response", f"{made.response.method}{misfit}")
    if made.lens is not None:
        line("lens", made.lens.words)
    if made.circle is not None:
        line("circle", made.circle.words)
    if made.vignetting is not None:
        v = made.vignetting
        fit = "" if v.residual is None else f", fitted within {100.0 * v.residual:.2g} % (RMS) up to {v.reach_deg:g}°"
        line("vignetting", f"{v.words}{fit}")
    for reading in made.spots:
        line(
            "spot",
            f"{reading.spot.words}: {figures(reading.spot.luminance, 4)} cd/m² by the meter, "
            f"{figures(made.factor * reading.mean, 4)} cd/m² in the picture ({reading.pixels} pixels, "
            f"± {100.0 * reading.spread:.1f} %)",
        )
    line("factor", f"{made.factor:.4g} ({'not calibrated' if made.calibration == 'none' else made.calibration})")
    line("range", f"{figures(made.least)} to {figures(made.most)} cd/m² on the axis")
    if made.illuminance is not None:
        text = f"{made.illuminance:.0f} lx"
        if made.difference_percent is not None and made.measured is not None:
            verdict = "accepted" if made.acceptable else "NOT ACCEPTABLE"
            text += f"; measured {made.measured:.0f} lx, {made.difference_percent:+.1f} %: {verdict}"
        line("E_v", text)
    line(
        "pixels",
        f"{made.saturated_pixels} too bright, {100.0 * made.dark_share:.2g} % too dark, "
        f"{100.0 * made.ghost_share:.2g} % contradicting",
    )
    for text in made.assumptions:
        line("assumed", text)
