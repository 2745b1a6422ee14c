#!/usr/bin/env python3
"""Pictures from the frames that a run left (frame_<seconds>.png).

  join_frames.py loop OUT.gif FRAMES_FOLDER LABEL [FRAMES_FOLDER LABEL ...]
      six seconds: the folders side by side, as many frames of each, evenly spaced
  join_frames.py last OUT.png FRAMES_FOLDER
      the last frame, made smaller
"""

import sys
from pathlib import Path

try:
    from PIL import Image, ImageDraw, ImageFont
except ImportError:
    sys.exit("error: Pillow is missing (Debian: python3-pil)")

SECONDS, FRAMES = 6, 60
SIDE = 300  # height of a loop [pixels]
LAST_WIDTH = 640
COLOURS = 96


def frames_in(folder):
    files = sorted(Path(folder).glob("frame_*.png"), key=lambda file: float(file.stem[6:]))
    if not files:
        sys.exit(f"error: {folder}: no frames")
    return files


def square(file):
    """Where the organ is: left of the plots, below the title, above the colour bar."""
    picture = Image.open(file).convert("RGB")
    side = picture.height * 79 // 100
    left, top = picture.width * 13 // 100, picture.height // 10
    return picture.crop((left, top, left + side, top + side)).resize((SIDE, SIDE), Image.LANCZOS)


def font(size):
    try:
        return ImageFont.truetype("DejaVuSans.ttf", size)
    except OSError:
        return ImageFont.load_default()


def loop(out, columns):
    writing = font(14)
    pictures = []
    for k in range(FRAMES):
        sheet = Image.new("RGB", (SIDE * len(columns), SIDE), "white")
        for place, (files, label) in enumerate(columns):
            sheet.paste(square(files[k * len(files) // FRAMES]), (place * SIDE, 0))
            ImageDraw.Draw(sheet).text((place * SIDE + 10, SIDE - 24), label, fill="white",
                                       font=writing)
        pictures.append(sheet.quantize(COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE))
    pictures[0].save(out, save_all=True, append_images=pictures[1:], loop=0,
                     duration=1000 * SECONDS // FRAMES, optimize=True)


def last(out, folder):
    picture = Image.open(frames_in(folder)[-1]).convert("RGB")
    height = picture.height * LAST_WIDTH // picture.width
    picture.resize((LAST_WIDTH, height), Image.LANCZOS).save(out, optimize=True)


def main():
    words = sys.argv[1:]
    if words in ([], ["-h"], ["--help"]):
        print(__doc__)
    elif words[0] == "loop" and len(words) >= 4 and len(words) % 2 == 0:
        columns = [(frames_in(words[i]), words[i + 1]) for i in range(2, len(words), 2)]
        loop(words[1], columns)
    elif words[0] == "last" and len(words) == 3:
        last(words[1], words[2])
    else:
        sys.exit("error: see join_frames.py --help")


if __name__ == "__main__":
    main()
