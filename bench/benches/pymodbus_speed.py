"""pymodbus on the clean stream of 1 MB that the other contenders get: frames/s and MB/s.

    pip install pymodbus
    python3 bench/benches/pymodbus_speed.py [ROUNDS]

Its RTU framer drops what follows the first frame in its buffer, so each frame is cut out for it by its length byte.
"""

import sys
import time

from pymodbus.framer import FramerRTU
from pymodbus.pdu import DecodePDU

MASK = (1 << 64) - 1


def clean_stream(length):
    """Replies of function 03 from unit 1 with 1 to 10 registers; the same bytes as `streams.rs` makes."""
    state = 0x9E3779B97F4A7C15

    def below(limit):
        nonlocal state
        state ^= state << 13 & MASK
        state ^= state >> 7
        state ^= state << 17 & MASK
        return (state >> 32) % limit

    stream = bytearray()
    while len(stream) < length:
        count = 2 * (1 + below(10))
        body = bytes([1, 3, count]) + bytes(below(256) for _ in range(count))
        stream += body + FramerRTU.compute_CRC(body).to_bytes(2, "big")
    return bytes(stream)


def run(stream):
    framer = FramerRTU(DecodePDU(is_server=False))
    frames = total = at = 0
    while at < len(stream):
        end = at + stream[at + 2] + 5
        _, pdu = framer.handleFrame(stream[at:end], 1, 0)
        if pdu is None:
            sys.exit(f"no frame at {at}")
        frames += 1
        total += sum(pdu.registers)
        at = end
    return frames, total


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    stream = clean_stream(1_000_000)
    best = float("inf")
    for _ in range(rounds):
        start = time.perf_counter()
        frames, total = run(stream)
        best = min(best, time.perf_counter() - start)
    megabytes = len(stream) / 1e6
    print(f"pymodbus: {frames} frames, sum {total}: {frames / best / 1000:.1f} k frames/s, {megabytes / best:.2f} MB/s")


main()
