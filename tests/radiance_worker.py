"""Look-ups by Radiance's library in a process of its own: it may crash, and freeing its data set crashes it.

Usage: radiance_worker.py FILE.xml QUESTIONS.npz ANSWERS.npz. The questions hold, for each name NAME, pairs of
directions as NAME.pairs (n, 4), incident directions as NAME.incident (m, 2), all in degrees to +z and from +x, and
NAME.flags.
"""

import os
import sys

import numpy as np
from pyradiance import bsdf


def main(file: str, questions: str, answers: str) -> None:
    data = bsdf.load_file(file)
    if data is None:
        sys.stderr.flush()
        os._exit(3)
    asked = np.load(questions)
    found = {}
    for name in (key.removesuffix(".pairs") for key in asked if key.endswith(".pairs")):
        flags = int(asked[f"{name}.flags"])
        found[f"{name}.values"] = np.array([bsdf.query(data, *row)[1] for row in asked[f"{name}.pairs"].tolist()])
        found[f"{name}.hemispherical"] = np.array(
            [bsdf.direct_hemi(data, *row, flags) for row in asked[f"{name}.incident"].tolist()]
        )
    np.savez(answers, **found)
    os._exit(0)


if __name__ == "__main__":
    main(*sys.argv[1:])
