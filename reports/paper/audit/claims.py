"""Contradictions in the first paper's claims and scores."""

from __future__ import annotations

import numpy as np

from ....bench.metrics import METRICS
from ....datasets.published_loop import (
    TABLE_4,
    TABLE_5,
    VERTICES,
)
from .. import printed
from ..dimensions import inconsistent
from ..loop import (
    READINGS,
    curve,
)
from ..rounding import half_step, interval
from .rows import Checks, Found

__all__ = ["CHECKS"]

CHECKS = Checks(paper=1)


@CHECKS.row(
    id="motor-gear", place="section 4.1, motor", severity="inconsistent",
    printed="MG6012E-i8v2 with a reduction ratio of 1:6", how="digit in the type name after 'i', and the maker's MG6012 ratio",
    reading="not used", note="External source: a vendor's table of the MG motors lists 8:1 for the MG6012 and 6:1 for the MG8016.",
)  # fmt: skip
def _() -> Found:
    named = int(str(printed.CLAIMS["motor"]).split("-i")[1].split("v")[0])
    told = int(str(printed.CLAIMS["gear"]).split(":")[1])
    return (
        f"1:{named} by its name, 1:{printed.MOTOR_GEAR} by the vendor",
        told != named == printed.MOTOR_GEAR,
        {"printed": told, "named": named},
    )


@CHECKS.row(
    id="error-bound", place="abstract, section 4.1, Fig. 16", severity="inconsistent",
    printed="torque error within 0.2 N·m, less than 0.3 N·m, at most 0.2 N·m", how="the three bounds stated for one model and test",
    reading="0.2 N·m", note="Compatible as inequalities; no text says which test the weaker one belongs to.",
)  # fmt: skip
def _() -> Found:
    bounds = [float(printed.CLAIMS[f"torque_error_{w}"]) for w in ("abstract", "section_4", "figure_16")]
    return (
        f"{min(bounds)} to {max(bounds)} N·m",
        min(bounds) < max(bounds),
        {"least": min(bounds), "greatest": max(bounds)},
    )


@CHECKS.row(
    id="fig16-two-models", place="section 4.1 on Fig. 16", severity="definition",
    printed="torque errors for the two models", how="models that have an error: measured and simulated torque give one error curve",
    reading="one curve, simulated minus measured",
)  # fmt: skip
def _() -> Found:
    compared = ("measured", "simulated")
    return (
        f"{len(compared) - 1} error curve",
        printed.CLAIMS["figures_16_models"] != len(compared) - 1,
        {"curves": len(compared) - 1},
    )


@CHECKS.row(
    id="mean-torque", place="section 4.1, average torque", severity="definition",
    printed="average torque 1.7 N·m simulated, 1.8 N·m measured", how="mean and mean modulus of the published loop over one cycle at constant speed",
    reading="the mean modulus",
    note="The text does not say that a modulus or a half cycle is meant.",
)  # fmt: skip
def _() -> Found:
    x = np.linspace(-1.0, 1.0, 20001)
    torque = np.concatenate([curve(READINGS[0].upper, x), curve(READINGS[0].lower, x)])
    mean, modulus = float(torque.mean()), float(np.abs(torque).mean())
    return (
        f"mean {mean:.2f} N·m, mean modulus {modulus:.2f} N·m",
        abs(mean - 1.8) > 1.0,
        {"mean": mean, "mean_modulus": modulus},
    )


@CHECKS.row(
    id="mean-torque-mae", place="section 4.1, 6 %, against Table 4", severity="inconsistent",
    printed="averages that differ by about 6 %, MAE 0.063 N·m", how="the difference of two means (or mean moduli) never exceeds the mean absolute error",
    reading="neither is used",
    note="5.5 to 6.5 % of 1.75 to 1.85 N·m is meant by 'about 6 %'. Fig. 17 and Table 4 may rest on different recordings; the text does not say so.",
)  # fmt: skip
def _() -> Found:
    c = printed.CLAIMS
    measured, simulated = float(c["mean_torque_measured"]), float(c["mean_torque_simulated"])
    share = (measured - simulated) / measured
    least = (float(c["mean_torque_error"]) - 0.005) * (measured - half_step(1))
    mae = TABLE_4["maxwell-slip"]["mae"]
    return (
        f"{share:.1%} from the printed averages; a difference of at least {least:.3f} N·m > MAE {mae} N·m",
        least > mae + half_step(3),
        {"share": share, "least_difference": least, "mae": mae},
    )


@CHECKS.row(
    id="t4-caption", place="caption of Table 4", severity="misprint", printed="comparison of two models",
    how="rows of the table", reading="three models",
)  # fmt: skip
def _() -> Found:
    return f"{len(TABLE_4)} models", len(TABLE_4) != printed.CLAIMS["models_in_captions"], {"models": len(TABLE_4)}


@CHECKS.row(
    id="t4-mre-unit", place="Table 4, MRE", severity="dimension", printed="MRE (N·m)",
    how="dimension of an average relative error; the largest deviations named for Fig. 19 as another reading",
    reading="mean of |error|/|torque| where |torque| is at least 5 % of its maximum, without unit",
    note="It is not the largest deviation either, which does have that unit: cubic 0.5 N·m against 0.271.",
)  # fmt: skip
def _() -> Found:
    said = inconsistent(1, "Table 4, MRE")
    return (
        said,
        bool(said) and any(v["mre"] > v["mae"] for v in TABLE_4.values()),
        {"cubic_mre": TABLE_4["cubic"]["mre"]},
    )


@CHECKS.row(
    id="t4-mrse", place="section 4.2", severity="misprint", printed="MRSE", how="the metric with the same letters",
    reading="RMSE",
)  # fmt: skip
def _() -> Found:
    printed_name = printed.CLAIMS["misspelt_metric"]
    same = [m.title for m in METRICS if sorted(m.title) == sorted(str(printed_name))]
    return ", ".join(same), same == ["RMSE"], {"letters_shared": len(same[0])}


@CHECKS.row(
    id="t5-caption", place="caption of Table 5", severity="misprint", printed="comparison error of torque of two models",
    how="rows of the table and their unit", reading="deflection errors of three inverse models, rad",
)  # fmt: skip
def _() -> Found:
    return (
        f"{len(TABLE_5)} models, in rad",
        len(TABLE_5) != printed.CLAIMS["models_in_captions"],
        {"models": len(TABLE_5)},
    )


@CHECKS.row(
    id="t5-mre-unit", place="Table 5, MRE", severity="dimension", printed="MRE (rad)", how="an error in rad divided by a deflection in rad",
    reading="as in Table 4, without unit",
)  # fmt: skip
def _() -> Found:
    ratio = {m: v["mre"] / v["mae"] for m, v in TABLE_5.items()}
    told = ", ".join(f"{m} {r:.1f}" for m, r in ratio.items())
    return (
        f"a ratio has no unit; MRE over MAE is {told}, 1 if both were mean errors in rad",
        min(ratio.values()) > 1.5,
        ratio,
    )


@CHECKS.row(
    id="t5-rmse-reduction", place="section 5, reductions", severity="arithmetic", printed="RMSE reduced by 7 %",
    how="1 − 0.051/0.056 from Table 5, proposed against cubic; MRE and MAE likewise",
    reading="8.9 %",
    note="The rounding of Table 5 allows 7.2 to 10.6 %, so 7 % is the very edge. 16 % and 21 % do follow. Against the "
    "Bouc-Wen model, which the sentence names too, the reductions are far larger.",
)  # fmt: skip
def _() -> Found:
    def reduction(metric: str, other: str = "cubic") -> float:
        return 1.0 - TABLE_5["maxwell-slip"][metric] / TABLE_5[other][metric]

    found = {m: reduction(m) for m in ("rmse", "mre", "mae")}
    half = half_step(printed.TABLE_DECIMALS[5])
    low, high = interval(
        lambda a, b: 1.0 - a / b, [TABLE_5["maxwell-slip"]["rmse"], TABLE_5["cubic"]["rmse"]], [half, half]
    )
    claimed = printed.CLAIMS["reduction"]
    differs = abs(found["rmse"] - claimed["rmse"]) > 0.005
    follows = all(abs(found[m] - claimed[m]) < 0.005 for m in ("mre", "mae"))
    return (
        f"RMSE {found['rmse']:.1%} ({low:.1%} to {high:.1%}), MRE {found['mre']:.1%}, MAE {found['mae']:.1%}; against "
        f"Bouc-Wen {reduction('rmse', 'bouc-wen'):.0%}, {reduction('mre', 'bouc-wen'):.0%}, {reduction('mae', 'bouc-wen'):.0%}",
        differs and follows,
        {**found, "rmse_low": low, "rmse_high": high},
    )


@CHECKS.row(
    id="abstract-deflection", place="abstract, last sentence", severity="inconsistent", printed="the deformation deflection is less than 0.15 rad",
    how="range of the tabulated deflection; section 5 states 0.15 rad as the largest error", reading="the deflection error is less than 0.15 rad",
)  # fmt: skip
def _() -> Found:
    span = max(abs(x) for x, _ in VERTICES.values())
    return f"deflections reach {span:g}", span > printed.CLAIMS["deflection_error"], {"largest": span}
