// What the rest of the studio tells the person about a body and about one moment of it.

export interface PersonShape {
  parts: { name: string; parent: number; mass_kg: number }[];
  limb: number[];
  muscles: { name: string; points: number; on: number[]; peak_force_n: number | null }[];
}

export interface Theme {
  dark: boolean;
}

/** Views into one frame: nothing here is copied or kept. */
export interface PersonPose {
  /** 7 per part: x y z qx qy qz qw */
  parts: Float32Array;
  /** path points then activation, muscle after muscle */
  muscles: Float32Array;
  fingertip: Float32Array;
}

export type Vec = readonly [number, number, number];
