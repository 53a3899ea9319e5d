"""Components replaced in a data set."""

import pytest

from clerestory import Bsdf, MissingDataError, Model


def test_only_what_is_named_is_replaced_and_metadata_stay():
    key, other = ("exterior", "transmission"), ("exterior", "reflection")
    bsdf = Bsdf.from_models({key: Model.lambertian(0.3), other: Model.lambertian(0.2)}).with_metadata(name="A")
    changed = bsdf.with_models({"visible": {key: Model.specular(0.5)}})
    assert changed.metadata.name == "A"
    assert {k: m.kind for k, m in changed.models["visible"].items()} == {key: "specular", other: "Lambertian"}
    assert bsdf.models["visible"][key].kind == "Lambertian"
    for band, missing in (("visible", ("interior", "reflection")), ("solar", key)):
        with pytest.raises(MissingDataError, match="could be replaced"):
            bsdf.with_models({band: {missing: Model.lambertian(0.1)}})
