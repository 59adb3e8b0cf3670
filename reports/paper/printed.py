"""What the two source papers print beside the tables of :mod:`hystbench.datasets.published_loop`.

Facts only: figures, claims and the resolution of the printed digits. The second paper was at hand as its abstract and
its appendices 1 and 2; its main text, with Eqs. 1-39 and Tables 1-6, was not.
"""

from __future__ import annotations

from typing import Any

__all__ = [
    "APPENDIX_CITED",
    "CITED",
    "CLAIMS",
    "EQUATION_1_SYMBOLS",
    "EQUATION_15_SYMBOLS",
    "EXPLAINED_AFTER_EQUATION_1",
    "FIGURE_SUBJECTS",
    "GLOSSARY",
    "INTRODUCED_MODELS",
    "LOOP_PATHS",
    "MAIN_EQUATIONS",
    "MOTOR_GEAR",
    "PAPERS",
    "SECOND_PAPER_DEGREE",
    "SLOPE_BOUNDS",
    "SPRING_RANGE",
    "STANDARD_GRAVITY",
    "SYMBOL_CLASHES",
    "TABLE_1_DECIMALS",
    "TABLE_2_DECIMALS",
    "TABLE_3_DECIMALS",
    "TABLE_DECIMALS",
]

PAPERS = {
    1: "H. Qin, Z. Zhang, Z. Hou, L. Li, K. Liu, S. Bai: Modeling and analysis of hysteresis using the Maxwell-slip model "
    "for variable stiffness actuators",
    2: "W. Choi, J. Won, J. Lee, J. Park: Low stiffness design and hysteresis compensation torque control of SEA for "
    "active exercise rehabilitation robots, Autonomous Robots 41 (2017), doi:10.1007/s10514-016-9591-z (abstract and "
    "appendices)",
}

TABLE_1_DECIMALS = {"x": 4, "torque": 2, "slope": 4}
"""Digits after the point; x_F is printed with three, and the zeros of A and G are the origin."""

TABLE_2_DECIMALS = {"x": 4, "torque": 2}

TABLE_3_DECIMALS = {"k": (4, 1, 0, 1), "eta": (2, 2, 3, 3), "k'": (2, 2, 2, 2), "eta'": (2, 2, 2, 2)}

TABLE_DECIMALS = {4: 3, 5: 3}

CLAIMS: dict[str, Any] = {
    "branches": 6,  # N of Tables 1 to 3 and of Eqs. 1, 6, A.12
    "preload_n": 5.0,  # section 2.1
    "belt_stretch_kg": 0.7,  # section 2.1, "maximum stretch"
    "elements": 4,  # section 4.1, "point number of 4"
    "torque_error_abstract": 0.2,  # N·m
    "torque_error_section_4": 0.3,  # N·m, section 4.1, first figure
    "torque_error_figure_16": 0.2,  # N·m
    "mean_torque_simulated": 1.7,  # N·m, section 4.1
    "mean_torque_measured": 1.8,  # N·m
    "mean_torque_error": 0.06,  # "about 6 %"
    "deflection_error": 0.15,  # rad, section 5
    "reduction": {"rmse": 0.07, "mre": 0.16, "mae": 0.21},  # section 5, of the inverse models
    "models_in_captions": 2,  # captions of Tables 4 and 5
    "gear": "1:6",  # section 4.1
    "motor": "MG6012E-i8v2",
    "figures_16_models": 2,  # "the two models" of Fig. 16
    "misspelt_metric": "MRSE",  # section 4.2
    "choi_degree": 3,  # section 1, the highest degree that Choi's model could express
}
"""Figures in the first paper's running text."""

FIGURE_SUBJECTS = {
    "1": "elbow joint",
    "2": "compliant elbow and its driver module",
    "3": "VSA from front (a) and back (b)",
    "4": "radial adjustment",
    "5": "prototype with 6 branches (a) and model of a single branch (b)",
    "6": "torque over deflection for N = 2, 4, 6",
    "7": "modified Maxwell-slip model",
    "8": "sliding of the elastic unit",
    "9": "force over position of a Maxwell-slip unit",
    "10": "block diagram",
    "11": "constructed hysteresis model with its vertices",
    "12": "transition phases 1 (a) and 2 (b)",
}
"""What each figure of the first paper shows, by its caption and the text."""

CITED = {
    "trajectory A-B-...-L-A": ("9", "vertices"),
    "individual compliant branches": ("3", "single branch"),
}
"""What section 3 and the appendix cite: the figure they name, and a word that the right figure's subject has."""

MAIN_EQUATIONS = {6: "virtual deformation h(θ)", 7: "torque by phase", 8: "ascending curve", 9: "descending curve"}
APPENDIX_CITED = {6: "stiffness", 7: "c1 and c2", 8: "overall stiffness", 9: "overall torque"}
"""What the main text's Eqs. 6-9 are, and what the appendix means by "Eq. (6)" to "Eq. (9)"."""

GLOSSARY = {"x_1", "x_2", "x_3", "x_4", "x"}
EQUATION_15_SYMBOLS = ("x", "x_1", "x_4", "x_p", "x_f")
"""Symbols that the text around Eqs. 7-15 explains, and those that Eq. 15 uses."""

EQUATION_1_SYMBOLS = ("T", "k", "l_1", "l_2", "l_3", "x_0", "θ")
EXPLAINED_AFTER_EQUATION_1 = ("k", "F_0")

INTRODUCED_MODELS = ("Preisach", "Bouc-Wen", "Preisach", "Prandtl-Ishlinskii", "Maxwell-slip")
"""The common models in the order in which section 1 lists them."""

SYMBOL_CLASHES = {
    "k_1, k_2": ("two parts of the joint stiffness in A.6", "element stiffnesses in Eq. 16 and Table 3"),
    "T": ("the torque", "written τ in Table 2"),
    "k+, k−": ("the transition slopes in Eq. 12", "written K+, K− in Table 1"),
}
"""Symbols of the first paper that stand for two things, and things that have two symbols."""

MOTOR_GEAR = 8
"""Gear ratio of the maker's MG6012 motors (vendor's table, shop.smc-powers.com); the type name says i8, too."""

STANDARD_GRAVITY = 9.80665
"""m/s²."""

SPRING_RANGE = {"permissible": 14.0, "identified": 16.0}
"""N·m, second paper, appendix 1; the latter is called a deformation range."""

LOOP_PATHS = {"44": ("OBAO", "OABO"), "45": ("CDFEC", "CDFEC"), "46": ("GIJHG", "GIJHG"), "50": ("KLK", "KLK")}
"""Second paper, appendix 2: the path named in the text and the one under the integral sign."""

SLOPE_BOUNDS = ("s_{+,min}", "s_{-,max}", "s_{,min}")
"""Second paper: the bounds in Eq. 42, in Eq. 43, and what the text calls the latter."""

SECOND_PAPER_DEGREE = 5
"""Degree of the curve polynomials that the second paper's appendix 1 uses."""
