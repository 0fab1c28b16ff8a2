// The colours of the person. One accent only: the muscles. All the rest is quiet clay.
import { Color } from 'three';
import type { Theme } from './types';

export interface Palette {
  clay: Color;
  /** the translucent skin of the simulated arm */
  skin: Color;
  bone: Color;
  tendon: Color;
  rest: Color;
  active: Color;
  stool: Color;
  shadow: Color;
  shadowStrength: number;
}

const LIGHT: Palette = {
  clay: new Color('#eceae8'),
  skin: new Color('#eceae8'),
  bone: new Color('#f4f1ea'),
  tendon: new Color('#e6d8d0'),
  rest: new Color('#c39c96'),
  active: new Color('#d92b1f'),
  stool: new Color('#b9c0c9'),
  shadow: new Color('#28323f'),
  shadowStrength: 0.34,
};

const DARK: Palette = {
  clay: new Color('#98a1ad'),
  skin: new Color('#a3adba'),
  bone: new Color('#c9c6bf'),
  tendon: new Color('#b3a29c'),
  rest: new Color('#94716f'),
  active: new Color('#ff3b28'),
  stool: new Color('#4b545f'),
  shadow: new Color('#000000'),
  shadowStrength: 0.5,
};

export const palette = (theme: Theme): Palette => (theme.dark ? DARK : LIGHT);
