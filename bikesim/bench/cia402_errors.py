"""The error codes of a CiA 402 drive (object 603F) for a person, and the fault it was found in."""

from bikesim.bench.cia402 import HEARTBEAT_LOST

# Of IEC 61800-7-201; the classes, by the first two digits, of CiA 301.
_ERRORS = {
    0x2310: "over current",
    0x2320: "short circuit or earth leakage",
    0x3110: "mains over-voltage",
    0x3120: "mains under-voltage",
    0x3210: "DC link over-voltage",
    0x3220: "DC link under-voltage",
    0x4210: "device too hot",
    0x4310: "drive too hot",
    0x7121: "motor blocked",
    0x7122: "motor or commutation",
    0x7305: "incremental sensor 1",
    0x8120: "CAN error passive",
    HEARTBEAT_LOST: "heartbeat of the host lost",
    0x8140: "recovered from bus off",
    0x8400: "speed controller",
    0x8500: "position controller",
    0x8611: "following error",
}
_CLASSES = {
    0x10: "generic", 0x20: "current", 0x21: "current, input side", 0x22: "current, inside",
    0x23: "current, output side", 0x30: "voltage", 0x31: "mains voltage",
    0x32: "voltage inside", 0x33: "output voltage", 0x40: "temperature",
    0x41: "ambient temperature", 0x42: "device temperature", 0x50: "hardware", 0x60: "software",
    0x61: "internal software", 0x62: "user software", 0x63: "data set",
    0x70: "additional modules", 0x80: "monitoring", 0x81: "communication", 0x82: "protocol",
    0x90: "external", 0xF0: "additional functions", 0xFF: "the maker's own",
}  # fmt: skip


def error_told(error: int) -> str:
    """As in `0x2310 (over current)`; the number alone where it is in no standard."""
    name = _ERRORS.get(error) or _CLASSES.get(error >> 8)
    return f"{error:#06x} ({name})" if name else f"{error:#06x}"


def found_in_fault(error: int) -> str:
    """What a person is told of a fault that is reset as a set-up begins.

    A drive whose host went away is in fault for that, as it must be.
    """
    if error == HEARTBEAT_LOST:
        return f"its host had gone (error {error:#06x}), reset now"
    return f"it was in fault {error_told(error)}, reset now"
