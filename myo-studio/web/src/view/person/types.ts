// What the rest of the studio tells the person about a body and about one moment of it.

import type { Group } from 'three';
import type { BodyShape } from '../../engine/protocol';

export type PersonShape = Pick<
  BodyShape,
  | 'parts'
  | 'limb'
  | 'bones'
  | 'looks'
  | 'is_person'
  | 'digits'
  | 'muscles'
  | 'is_left'
  | 'stature_m'
  | 'moves_hand_only'
>;

/** What is drawn of a body. */
export interface Figure {
  readonly group: Group;
  /** how many times as tall as the figure as it is made */
  readonly size: number;
  readonly isLeft: boolean;
  /** what the camera stands near to, from the first pose on; nothing of a whole person */
  near: Near | undefined;
  /** height of the floor (m), unless it is that under the person */
  floor: number | undefined;
  pose(given: PersonPose): void;
  setTheme(theme: Theme): void;
  setFirstPerson(on: boolean): void;
  setSitting(on: boolean): void;
  /** With fewer triangles: for as long as it moves and has no graphics card. */
  setRough(on: boolean): void;
  eye(): { position: [number, number, number]; forward: [number, number, number] };
  dispose(): void;
}

/** A ball of space (m). */
export interface Near {
  at: [number, number, number];
  radius: number;
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
