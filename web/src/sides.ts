// Two files in one picture: on a split screen, or left and right of a line that is swiped over the picture.
import type { Group } from 'three';

/** What a viewer draws left and right. */
export interface Sides {
  mode: 'split' | 'swipe';
  left: Group;
  right: Group;
  /** Where the line of a swipe is, from 0 to 1. */
  share: number;
}

/** A part of the canvas: the file that is drawn there (null for all), its first pixel and its width in CSS pixels. */
interface Part {
  side: Group | null;
  from: number;
  width: number;
}

/** Width of the picture that the camera makes: half of the canvas on a split screen. */
export function viewWidth(sides: Sides | null, width: number): number {
  return Math.max(1, width / (sides?.mode === 'split' ? 2 : 1));
}

/** The parts of a canvas of a width that are not empty. */
export function partsOf(sides: Sides | null, width: number): Part[] {
  if (!sides) return [{ side: null, from: 0, width }];
  const { mode, left, right, share } = sides;
  const line = Math.round(width * (mode === 'split' ? 0.5 : share));
  const parts = [
    { side: left, from: 0, width: line },
    { side: right, from: line, width: width - line },
  ];
  return parts.filter((part) => part.width > 0);
}

/** The side, and the place within its picture, of a place of the canvas. */
export function sideAt(sides: Sides | null, width: number, x: number): { x: number; side: Group | null } {
  if (!sides) return { x, side: null };
  const line = width * (sides.mode === 'split' ? 0.5 : sides.share);
  return { x: sides.mode === 'split' && x >= line ? x - line : x, side: x < line ? sides.left : sides.right };
}

/** Calls `draw` while only one side's file of all `groups`, and what is drawn `beside` it, can be seen. */
export function withOnly<T>(groups: Group[], side: Group | null, beside: Group[], draw: () => T): T {
  if (!side) return draw();
  const before = groups.map((group) => group.visible);
  groups.forEach((group) => (group.visible = group.visible && (group === side || beside.includes(group))));
  const out = draw();
  groups.forEach((group, k) => (group.visible = before[k]!));
  return out;
}
