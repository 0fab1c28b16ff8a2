// What the rest of the studio tells the person about a body and about one moment of it.

import type { BodyShape } from '../../engine/protocol';

export type PersonShape = Pick<
  BodyShape,
  'parts' | 'limb' | 'digits' | 'muscles' | 'is_left' | 'stature_m' | 'moves_hand_only'
>;

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
