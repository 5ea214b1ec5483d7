// The part of the view that no panel covers, and cameras that show a box within it.
import { type Box3, type PerspectiveCamera, Vector3 } from 'three';

/** A rectangle of the canvas in CSS pixels. */
export interface Free {
  left: number;
  top: number;
  width: number;
  height: number;
}

const PANELS = ['#details', '#images', '#library', '#panel', 'header', '#legend'];
/** Times the least distance from which all of a box is seen. */
const MARGIN = 1.08;

/** The part of the canvas beside the panels that are open, or all of it where they leave little. */
export function freePart(canvas: HTMLElement): Free {
  const view = canvas.getBoundingClientRect();
  let [left, top, right, bottom] = [view.left, view.top, view.right, view.bottom];
  for (const panel of PANELS) {
    const box = document.querySelector(panel)?.getBoundingClientRect();
    if (!box || box.width === 0 || box.height === 0) continue;
    const inside = box.left < right && box.right > left && box.top < bottom && box.bottom > top;
    if (!inside) continue;
    // The panel takes the side of the view that costs the least of it.
    const rest = [
      { share: (bottom - top) * (box.left - left), cut: () => (right = box.left) },
      { share: (bottom - top) * (right - box.right), cut: () => (left = box.right) },
      { share: (right - left) * (box.top - top), cut: () => (bottom = box.top) },
      { share: (right - left) * (bottom - box.bottom), cut: () => (top = box.bottom) },
    ];
    rest.sort((a, b) => b.share - a.share)[0]!.cut();
  }
  const free = { left: left - view.left, top: top - view.top, width: right - left, height: bottom - top };
  const enough = free.width >= 120 && free.height >= 120;
  return enough ? free : { left: 0, top: 0, width: view.width, height: view.height };
}

/** Puts the middle of a camera's picture of a size into the middle of a part of it. */
export function centreIn(camera: PerspectiveCamera, free: Free, width: number, height: number): void {
  const dx = free.left + free.width / 2 - width / 2;
  const dy = free.top + free.height / 2 - height / 2;
  camera.setViewOffset(width, height, -dx, -dy, width, height);
}

/** The distance from which a camera that looks in the direction `ahead` sees a box within the given slopes. */
export function distanceTo(box: Box3, ahead: Vector3, across: number, upright: number): number {
  const right = ahead.clone().cross(new Vector3(0, 0, 1));
  if (right.lengthSq() < 1e-9) right.set(1, 0, 0);
  right.normalize();
  const up = right.clone().cross(ahead);
  const half = box.getSize(new Vector3()).multiplyScalar(0.5);
  let out = 2 / MARGIN;
  for (let k = 0; k < 8; ++k) {
    const corner = half.clone().multiply(new Vector3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1));
    const depth = corner.dot(ahead);
    out = Math.max(out, Math.abs(corner.dot(right)) / across - depth, Math.abs(corner.dot(up)) / upright - depth);
  }
  return out * MARGIN;
}
