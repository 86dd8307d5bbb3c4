#!/usr/bin/env bash
# Guess: the unit of viscosity that rheometers write without a space or dot, "mPas" or "Pas", is
#   read by pint as mPa s, or refused like "Ns".
# Version: Pint 0.25.3
# Behaviour: an s at the end of a name is its plural: "mPas" is millipascals, a pressure, and "Pas"
#   is pascals. No error comes up before something is converted to a viscosity. And "mNm", the unit
#   of the same instruments' torque, is thousandths of a number metric, the fineness of yarn.
# Output seen: mPa s: millipascal * second; mPas: millipascal; Pas: pascal; Ns: refused; mNm:
#   millinumber_meter
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check Pint==0.25.3
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import pint

units = pint.UnitRegistry()


def read(text):
    try:
        return units.Quantity(1, text)
    except pint.UndefinedUnitError:
        return "refused"


seen = {text: read(text) for text in ("mPa s", "mPa.s", "mPas", "Pas", "Ns", "mNm")}
for text, found in seen.items():
    print(f"{text}: {found if found == 'refused' else found.units}")
assert seen["mPa s"].check("[viscosity]") and seen["mPa.s"].check("[viscosity]"), "no viscosity"
assert seen["Ns"] == "refused", "a newton second is read now"
assert seen["mPas"].check("[pressure]") and seen["Pas"].check("[pressure]"), "mPas is refused now"
assert seen["mPas"].m_as("Pa") == 1e-3, "mPas is another pressure now"
assert seen["mNm"].check("[length] / [mass]"), "mNm is no fineness any more"
PYTHON
