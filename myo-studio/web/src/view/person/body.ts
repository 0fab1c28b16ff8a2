// Triangles for the still parts of the person, sculpted from their soft clay.
import { type BufferGeometry, CylinderGeometry, Matrix4, Vector3 } from 'three';
import { mergeGeometries } from 'three/addons/utils/BufferGeometryUtils.js';
import { mirrored } from './field';
import { HEAD_REGION, LEFT_WRIST, MIDDLE, bodyRegions, figure, floorHeight } from './figure';
import { HAND_REGION, type HandFrame, openHand, pointingHand, restingHand } from './hand';
import type { Digits } from './digits';
import { type Region, sculpt } from './sculpt';
import type { Vec } from './types';

export const headGeometry = (): BufferGeometry => sculpt(figure(false), [HEAD_REGION]);

export const handGeometry = (): BufferGeometry => sculpt(pointingHand(), [HAND_REGION]);

/** The palm of a hand whose fingers move, as they have it at the moment. */
export function palmGeometry({ matrix }: HandFrame, { all, order, thumb }: Digits): BufferGeometry {
  const back = matrix.clone().invert();
  const base = (digit: number): Vec => all[digit]![0]!.clone().applyMatrix4(back).toArray();
  const knuckles = order.filter((digit) => digit !== thumb).map(base);
  return sculpt(openHand(knuckles, thumb === undefined ? undefined : base(thumb)), [HAND_REGION]);
}

/** `coarse`: how much larger the triangles are than at their finest */
export function bodyGeometry(sitting: boolean, coarse = 1): BufferGeometry {
  const regions = bodyRegions(sitting).map((region) => coarser(region, coarse));
  const parts = [sculpt(figure(sitting), regions), leftHand()];
  const whole = mergeGeometries(parts);
  for (const part of parts) part.dispose();
  return whole;
}

/** Larger cells need a wider overlap with the regions around. */
function coarser({ low, high, cell }: Region, by: number): Region {
  const more = cell * (by - 1);
  return { low, high: [high[0], high[1], high[2] + more], cell: cell * by };
}

/** Hangs down, the back of the hand outwards and the thumb forwards. */
function leftHand(): BufferGeometry {
  const { low, high } = HAND_REGION;
  const region: Region = { low: [low[0], -high[1], low[2]], high: [high[0], -low[1], high[2]], cell: 0.0098 };
  const hand = sculpt(
    restingHand().map((blob) => mirrored(blob, 0)),
    [region],
  );
  const fingers = new Vector3(0.34, 0, -0.94).normalize();
  const back = new Vector3(0.35, 1, 0);
  back.addScaledVector(fingers, -back.dot(fingers)).normalize();
  const side = new Vector3().crossVectors(back, fingers);
  const frame = new Matrix4().makeBasis(fingers, side, back);
  frame.setPosition(LEFT_WRIST[0], MIDDLE + LEFT_WRIST[1], LEFT_WRIST[2]);
  return hand.applyMatrix4(frame);
}

const SEAT_HEIGHT = 0.39;

export function stoolGeometry(): BufferGeometry {
  const stool = new CylinderGeometry(0.19, 0.15, SEAT_HEIGHT, 32);
  stool.rotateX(Math.PI / 2);
  return stool.translate(-0.01, MIDDLE, floorHeight(true) + SEAT_HEIGHT / 2);
}
