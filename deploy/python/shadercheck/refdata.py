"""Reference data in NumPy: inputs, expected outputs, and how far an output may be off."""

import json
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class RefData:
    """A file of ``shadercheck refdata generate``.

    Arrays are by the names of the shader. The first axis is the sample, or the case for ``cases``: sample n belongs to case
    ``n // per_case``. A matrix has its columns first.
    """

    #: What the file says about itself: suite, formula, profile, seed, versions, digest.
    provenance: dict
    #: Attributes, arguments and inputs of primitives, one for each sample; binary32 or 32-bit integers.
    inputs: dict
    #: Uniforms, one for each case.
    cases: dict
    #: Outputs as they should be, in binary64.
    expected: dict
    #: The nearest numbers that the outputs can hold.
    nearest: dict
    #: How far outputs may be from ``expected``, in binary32, infinite where nothing bounds them; empty without a profile.
    bound: dict
    #: 16 bits for each sample; ``provenance["flags"]`` says what they mean.
    flags: np.ndarray

    @property
    def per_case(self):
        """Samples that share a set of uniforms."""
        return self.provenance["per_case"]

    def case(self, name):
        """The uniform ``name`` for each sample."""
        return np.repeat(self.cases[name], self.per_case, axis=0)[: self.provenance["rows"]]

    def within(self, actual, name):
        """Which elements of ``actual`` are within their bounds. NaN is within none."""
        if name not in self.expected:
            raise KeyError(f"there is no output {name!r}; the outputs are {', '.join(self.expected)}")
        if name not in self.bound:
            raise KeyError(f"{name!r} has no bound; generate the file with a profile")
        actual = np.asarray(actual, dtype=np.float64)
        wanted = self.expected[name].shape
        if actual.shape != wanted:
            raise ValueError(f"the array has shape {actual.shape}, and {name!r} has {wanted}: one row for each sample")
        off = np.abs(actual - self.expected[name])
        return off <= self.bound[name].astype(np.float64)


def read(path):
    """Reads an NPZ of ``shadercheck refdata generate``.

    Raises:
        ValueError: the file has another schema.
    """
    with np.load(path) as file:
        if "provenance" not in file:
            raise ValueError(f"{path}: no provenance; it is not written by `shadercheck refdata generate`")
        provenance = json.loads(file["provenance"].tobytes())
        if provenance["schema"] != "shadercheck-refdata" or not provenance["schema_version"].startswith("1."):
            raise ValueError(f"{path}: schema {provenance['schema']} {provenance['schema_version']}; version 1 is read")
        arrays = {array["name"]: file[array["name"]] for array in provenance["arrays"]}

    def of(kind):
        return {name[len(kind) + 1 :]: values for name, values in arrays.items() if name.startswith(kind + ".")}

    return RefData(
        provenance, of("input"), of("case"), of("expected"), of("nearest"), of("bound"), arrays["flags"]
    )
