// The parts of the person that nothing moves: trunk, neck, head, legs and the left arm, as soft clay around the
// simulated right shoulder. Measures are those of an adult as tall as FIGURE; the origin is the right shoulder.
import { Blob, mirrored } from './field';
import type { Region } from './sculpt';
import type { Vec } from './types';

/** stature of the figure as its measures are (m), which is that of the usual model */
export const FIGURE = 1.735;

/** the body's mid-plane */
export const MIDDLE = 0.17;

export const floorHeight = (sitting: boolean): number => (sitting ? -1.01 : -1.43);

/** Between the eyes, a little before the face. */
export const EYE: Vec = [0.1, MIDDLE, 0.205];

/** A blob whose sideways places are given from the mid-plane, to the left. */
function at(a: Vec, b: Vec, ra: number, rb: number, melt: number, carve = false): Blob {
  return new Blob([a[0], MIDDLE + a[1], a[2]], [b[0], MIDDLE + b[1], b[2]], ra, rb, melt, carve);
}

const both = (blob: Blob): Blob[] => [blob, mirrored(blob, MIDDLE)];

/** The upper trunk on which the muscles of the shoulder lie. */
export function chest(): Blob[] {
  return [
    at([-0.02, -0.072, -0.075], [-0.02, 0.072, -0.075], 0.086, 0.086, 0.05),
    at([-0.008, -0.048, -0.19], [-0.008, 0.048, -0.19], 0.09, 0.09, 0.1),
    at([-0.008, -0.052, -0.36], [-0.008, 0.052, -0.36], 0.077, 0.077, 0.13),
    at([-0.044, 0, -0.02], [-0.016, 0, 0.12], 0.058, 0.05, 0.05),
    ...both(at([-0.04, 0.03, 0.035], [-0.034, 0.135, 0.012], 0.036, 0.034, 0.06)),
    // the muscles of the chest, the shoulder blades and their ridges
    ...both(at([0.018, 0.06, -0.1], [0.008, 0.1, -0.085], 0.054, 0.048, 0.06)),
    ...both(at([-0.078, 0.092, -0.005], [-0.083, 0.088, -0.085], 0.026, 0.02, 0.07)),
    ...both(at([-0.078, 0.092, -0.0], [-0.056, 0.138, 0.02], 0.023, 0.02, 0.06)),
  ];
}

/** The left shoulder and arm, hanging, a little bent at the elbow. */
function leftArm(): Blob[] {
  return [
    at([-0.014, 0.165, -0.008], [-0.006, 0.19, -0.12], 0.052, 0.045, 0.045),
    at([-0.008, 0.183, -0.08], [-0.024, 0.228, -0.285], 0.046, 0.0345, 0.012),
    at([-0.024, 0.228, -0.285], [0.0, 0.236, -0.36], 0.034, 0.0365, 0.012),
    at([0.0, 0.236, -0.36], LEFT_WRIST, 0.0365, 0.0195, 0.012),
  ];
}

export const LEFT_WRIST: Vec = [0.062, 0.238, -0.53];

function pelvis(): Blob[] {
  return [
    at([-0.018, -0.066, -0.495], [-0.018, 0.066, -0.495], 0.086, 0.086, 0.13),
    at([-0.022, 0, -0.53], [-0.022, 0, -0.57], 0.07, 0.055, 0.04),
    ...both(at([-0.05, 0.066, -0.55], [-0.045, 0.07, -0.575], 0.076, 0.072, 0.05)),
  ];
}

function legs(sitting: boolean): Blob[] {
  const hip: Vec = [-0.01, 0.084, -0.53];
  const knee: Vec = sitting ? [0.4, 0.115, -0.525] : [0.002, 0.09, -0.93];
  const ankle: Vec = sitting ? [0.37, 0.12, -0.93] : [-0.032, 0.096, -1.35];
  const calf: Vec = [
    knee[0] + 0.3 * (ankle[0] - knee[0]) - 0.014,
    knee[1] + 0.3 * (ankle[1] - knee[1]),
    knee[2] + 0.3 * (ankle[2] - knee[2]),
  ];
  return [
    at(hip, knee, 0.084, 0.05, 0.04),
    at(knee, calf, 0.049, 0.0495, 0.018),
    at(calf, ankle, 0.0495, 0.033, 0.016),
    ...foot(ankle, sitting ? 0.035 : 0.03),
  ].flatMap(both);
}

/** Two blobs side by side make the foot wider than high; `turn` points the toes a little outwards. */
function foot(ankle: Vec, turn: number): Blob[] {
  const [x, y, z] = ankle;
  const sole = z - 0.08;
  return [
    at([x - 0.026, y, sole + 0.033], [x, y, z], 0.033, 0.031, 0.02),
    at([x - 0.026, y, sole + 0.033], [x + 0.165, y + turn - 0.018, sole + 0.023], 0.033, 0.022, 0.02),
    at([x - 0.026, y, sole + 0.033], [x + 0.15, y + turn + 0.018, sole + 0.021], 0.033, 0.02, 0.03),
    at([x, y, z], [x + 0.11, y + turn * 0.7, sole + 0.03], 0.031, 0.026, 0.03),
  ];
}

/** An abstract face: planes of brow, nose and chin are enough to see where the person looks. */
function head(): Blob[] {
  return [
    at([-0.036, 0, 0.226], [0.02, 0, 0.236], 0.075, 0.072, 0.03),
    at([-0.008, 0, 0.244], [-0.008, 0, 0.244], 0.073, 0.073, 0.03),
    at([0.022, 0, 0.21], [0.03, 0, 0.146], 0.067, 0.05, 0.04),
    ...both(at([-0.004, 0.042, 0.185], [0.034, 0.024, 0.138], 0.029, 0.025, 0.045)),
    at([0.064, 0, 0.128], [0.064, 0, 0.128], 0.015, 0.015, 0.035),
    at([0.082, -0.024, 0.228], [0.082, 0.024, 0.228], 0.01, 0.01, 0.035),
    ...both(at([0.119, 0.036, 0.206], [0.113, 0.048, 0.204], 0.018, 0.017, 0.034, true)),
    at([0.083, 0, 0.216], [0.097, 0, 0.186], 0.009, 0.0115, 0.028),
    at([0.096, 0, 0.184], [0.077, 0, 0.158], 0.011, 0.014, 0.03),
  ];
}

export function figure(sitting: boolean): Blob[] {
  return [...chest(), ...pelvis(), ...legs(sitting), ...leftArm(), ...head()];
}

/** Where the neck is cut, so that the head can be hidden in the first-person view. */
const NECK = 0.075;

export const HEAD_REGION: Region = { low: [-0.13, 0.06, NECK - 0.01], high: [0.15, 0.28, 0.335], cell: 0.015 };

/** Regions overlap by more than a cell, so that nothing shows between them. */
export function bodyRegions(sitting: boolean): Region[] {
  const floor = floorHeight(sitting) - 0.02;
  const knees = sitting ? 0.6 : 0.2;
  return [
    { low: [-0.19, -0.06, -0.3], high: [0.16, 0.47, NECK + 0.02], cell: 0.0265 },
    { low: [-0.19, -0.06, -0.64], high: [sitting ? 0.15 : 0.16, 0.345, -0.25], cell: 0.032 },
    { low: [-0.1, 0.335, -0.56], high: [0.11, 0.5, -0.25], cell: 0.0215 },
    { low: [sitting ? 0.08 : -0.19, -0.04, floor], high: [knees, 0.38, sitting ? -0.4 : -0.57], cell: 0.0305 },
  ];
}
