"""PNG pictures as browsers write them: 8 bits, without interlacing."""

import struct
import zlib


def read(data):
    """Width, height, and rows of (r, g, b) bytes."""
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError("this is no PNG file")
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at : at + 8])
        part = data[at + 8 : at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", part)
        elif kind == b"IDAT":
            packed += part
        at += 12 + size
    if depth != 8 or colour not in (2, 6) or interlaced:
        raise ValueError(f"expected 8 bits RGB or RGBA, found {depth} bits, colour type {colour}, interlace {interlaced}")
    channels = 3 if colour == 2 else 4
    raw, stride = zlib.decompress(packed), width * channels
    rows, before = [], bytearray(stride)
    for row in range(height):
        start = row * (stride + 1)
        before = unfilter(raw[start], bytearray(raw[start + 1 : start + 1 + stride]), before, channels)
        rows.append(bytes(byte for index, byte in enumerate(before) if channels == 3 or index % 4 != 3))
    return width, height, rows


def unfilter(kind, row, before, channels):
    for index in range(len(row) if kind else 0):
        left = row[index - channels] if index >= channels else 0
        up = before[index]
        corner = before[index - channels] if index >= channels else 0
        row[index] = (row[index] + (0, left, up, (left + up) // 2, paeth(left, up, corner))[kind]) & 255
    return row


def paeth(left, up, corner):
    guess = left + up - corner
    return min((left, up, corner), key=lambda value: abs(guess - value))


def differences(first, second):
    """Mean difference of all bytes, and the share of bytes that differ by more than 40; (255, 1) for other sizes."""
    (width, height, ours), (other_width, other_height, theirs) = read(first), read(second)
    if (width, height) != (other_width, other_height):
        return 255.0, 1.0
    apart = [abs(a - b) for one, two in zip(ours, theirs) for a, b in zip(one, two)]
    return sum(apart) / len(apart), sum(difference > 40 for difference in apart) / len(apart)
