"""How far is a quick picture from the path tracer's?"""

import scuro
from scuro.measure import score

SIZE = (320, 240)
SAMPLES = 16


def main() -> None:
    scene = scuro.load("sample:1hpv")
    truth = scuro.render(scene, size=SIZE, renderer="path", path__samples=SAMPLES, path__bounces=1)
    quick = scuro.render(scene, size=SIZE)
    scores = score(quick.pixels[..., :3] / 255, truth.pixels[..., :3] / 255)
    print(f"SSIM {scores.ssim:.3f}, mean CIE ΔE2000 {scores.delta_e:.2f}")


if __name__ == "__main__":
    main()
