// Written from myo-studio/src/protocol; its tests say how.

/**
 * How bad it is.
 */
export type Severity = "error" | "warning";

/**
 * Something wrong or odd.
 */
export type Finding = { 
/**
 * Whether it can be trained all the same.
 */
severity: Severity, 
/**
 * One sentence, that of the command line.
 */
message: string, 
/**
 * Path of the value that it is about, such as `scene.ball.radius`; none for the text as a whole.
 */
path: string | null, 
/**
 * Line in the text, from 1.
 */
line: number | null, 
/**
 * Column in the text, from 1.
 */
column: number | null, };

/**
 * What an object is.
 */
export type ObjectKind = "sphere" | "button" | "slider" | "stick" | "obstacle";

/**
 * Something with a place.
 */
export type ObjectView = { 
/**
 * What people call it.
 */
name: string, 
/**
 * Path of what describes it.
 */
path: string, 
/**
 * What it is.
 */
kind: ObjectKind, 
/**
 * Its centre; the middle of where it may be (m).
 */
at: [number, number, number], 
/**
 * Its own axes: x up its upright face, y across it to the left, z out of it; quaternion, `x y z w`.
 */
rotation: [number, number, number, number], 
/**
 * Half its sizes along them; the middle of what is drawn (m). Of a sphere three times the radius.
 */
half_size: [number, number, number], 
/**
 * Three ways (m, world axes) along which its place is drawn, from minus one half of each to one half; zeros where it stands still.
 */
drawn: [[number, number, number], [number, number, number], [number, number, number]], 
/**
 * Where the hinge of a stick is (m).
 */
hinge: [number, number, number] | null, 
/**
 * The handle of a slider: where it stands at first, half its sizes (m).
 */
handle: [[number, number, number], [number, number, number]] | null, 
/**
 * Numbers of the steps that ask for it, from 0.
 */
steps: Array<number>, };

/**
 * Something that is to do.
 */
export type StepView = { 
/**
 * For people, such as `press panel.ok`.
 */
label: string, 
/**
 * Path of what asks for it, such as `script[1].press[2]`.
 */
path: string, 
/**
 * Indices of the objects that it may ask for.
 */
objects: Array<number>, };

/**
 * What a part of the scene is written as.
 */
export type ItemView = { 
/**
 * What scripts call it, such as `panel.ok`.
 */
name: string, 
/**
 * Path in the text, such as `scene.panel.objects.ok`.
 */
path: string, 
/**
 * `sphere`, `button`, `group`, `grid` and so on.
 */
kind: string, 
/**
 * Origin of the axes along which its place is written (m).
 */
parent_at: [number, number, number], 
/**
 * These axes: quaternion, `x y z w`.
 */
parent_rotation: [number, number, number, number], 
/**
 * Factor for the lengths written in it.
 */
parent_scale: number, 
/**
 * Where it is (m), in world axes; the middle of where it may be.
 */
at: [number, number, number], 
/**
 * Its own axes: quaternion, `x y z w`.
 */
rotation: [number, number, number, number], 
/**
 * Indices of its objects.
 */
objects: Array<number>, };

/**
 * A task, written out.
 */
export type TaskView = { 
/**
 * Its name.
 */
name: string, 
/**
 * What it says of itself.
 */
description: string, 
/**
 * Name or file of the model.
 */
model: string, 
/**
 * What its user changes of it.
 */
body: unknown, 
/**
 * What points.
 */
technique: string, 
/**
 * Longest episode (s).
 */
time_limit_s: number, 
/**
 * Everything that stands there.
 */
objects: Array<ObjectView>, 
/**
 * Everything that is to do.
 */
steps: Array<StepView>, 
/**
 * What the scene is written as: objects, groups and generators, each before what is in it.
 */
items: Array<ItemView>, };

/**
 * What stands in the text of a task.
 */
export type Look = { 
/**
 * What is wrong or odd, reach aside.
 */
findings: Array<Finding>, 
/**
 * What stands there; none where the text cannot be read.
 */
view: TaskView | null, };

/**
 * A task that comes with the engine.
 */
export type PresetCard = { 
/**
 * Its name.
 */
name: string, 
/**
 * What it says of itself.
 */
description: string, 
/**
 * Its text, comments included.
 */
text: string, 
/**
 * Number of its steps.
 */
steps: number, 
/**
 * A picture (SVG).
 */
picture: string, };

/**
 * A task file that was kept.
 */
export type TaskFile = { 
/**
 * Its name: that of the file without its ending.
 */
name: string, 
/**
 * When it was last written (s since 1970).
 */
changed_s: number, };

/**
 * The text of a task.
 */
export type TaskText = { 
/**
 * Name of the file.
 */
name: string, 
/**
 * What stands in it.
 */
text: string, };

/**
 * A surface of triangles.
 */
export type Surface = { 
/**
 * Corners (m).
 */
points: Array<[number, number, number]>, 
/**
 * Indices of the corners of each triangle.
 */
triangles: Array<[number, number, number]>, };

/**
 * A rigid body.
 */
export type BodyPart = { 
/**
 * Name.
 */
name: string, 
/**
 * Index of the part that it hangs on; of the world, itself.
 */
parent: number, 
/**
 * Mass (kg).
 */
mass_kg: number, };

/**
 * Triangles fixed to a part.
 */
export type LookShape = { 
/**
 * Index of the part.
 */
part: number, 
/**
 * Position of their frame in that of the part (m).
 */
pos: [number, number, number], 
/**
 * Its orientation there, `x y z w`.
 */
quat: [number, number, number, number], 
/**
 * Unit of the points (m).
 */
step: number, 
/**
 * Points in that unit: whole numbers of 16 bits, the lower byte first, in base 64.
 */
points: string, 
/**
 * Indices of the points of triangles, of 16 bits without sign, in base 64.
 */
faces: string, };

/**
 * A bone.
 */
export type BoneShape = { 
/**
 * Indices of the parts that its ends are fixed to.
 */
parts: [number, number], 
/**
 * Its ends, as seen in these (m).
 */
ends: [[number, number, number], [number, number, number]], };

/**
 * A finger or thumb.
 */
export type DigitShape = { 
/**
 * Indices of its parts, the one next to the palm first.
 */
parts: Array<number>, 
/**
 * Its tip, as seen in the last of them (m).
 */
tip: [number, number, number], };

/**
 * A muscle.
 */
export type MuscleShape = { 
/**
 * Name.
 */
name: string, 
/**
 * Number of points of its path, from origin to insertion.
 */
points: number, 
/**
 * Index of the part that each point is fixed to.
 */
on: Array<number>, 
/**
 * Force of the muscle at full activation and its best length (N), where the model states it.
 */
peak_force_n: number | null, };

/**
 * What of a body stays the same whatever it does.
 */
export type BodyShape = { 
/**
 * Name of the model.
 */
name: string, 
/**
 * Its bodies, the world first, parents before children.
 */
parts: Array<BodyPart>, 
/**
 * Indices of the parts from the upper arm down to the hand.
 */
limb: Array<number>, 
/**
 * Fingers and thumb that move; none of a hand whose fingers are held.
 */
digits: Array<DigitShape>, 
/**
 * Its muscles.
 */
muscles: Array<MuscleShape>, 
/**
 * Whether it is a left arm.
 */
is_left: boolean, 
/**
 * What is seen of parts, where more is known than their bones.
 */
looks: Array<LookShape>, 
/**
 * Whether it is the arm of a person who faces along x, who is drawn around it; of any other body its bones are.
 */
is_person: boolean, 
/**
 * Its bones.
 */
bones: Array<BoneShape>, 
/**
 * Whether nothing moves from the trunk to the elbow.
 */
moves_hand_only: boolean, 
/**
 * Stature of the person (m), where it is known.
 */
stature_m: number | null, 
/**
 * Names of the independent joints, in the order of [`MotionLayout::joints`].
 */
joints: Array<string>, };

/**
 * What a [`Motion`](super::Message::Motion) is a motion of, and how its numbers lie.
 */
export type MotionLayout = { 
/**
 * Parts of the body: of each its origin (m from the shoulder centre, world axes) and its orientation as a quaternion, `x y z w`.
 */
parts: number, 
/**
 * Points of each muscle: of each muscle its points (m), then its activation in [0, 1].
 */
muscle_points: Array<number>, 
/**
 * Independent joints: of each its coordinate (rad).
 */
joints: number, 
/**
 * Objects of the task: of each its centre (m), its orientation `x y z w`, half its sizes along its own axes (m), its value (NaN without
 * one), its part in the task (0 current, 1 later, 2 done, 3 bystander).
 */
objects: number, };

/**
 * What comes before the numbers of a motion.
 */
export type MotionHeader = { 
/**
 * Of the question that it answers; none where it comes by itself, as those who watch a training get it.
 */
id: number | null, 
/**
 * The training that is watched.
 */
job: number | null, 
/**
 * Control steps that the policy was trained for.
 */
env_steps: number, 
/**
 * Time from one frame to the next (s).
 */
frame_s: number, 
/**
 * How the numbers of a frame lie.
 */
layout: MotionLayout, 
/**
 * Numbers of a frame.
 */
frame_size: number, };

/**
 * What to train and how.
 */
export type JobOrder = { 
/**
 * Text of the task.
 */
text: string, 
/**
 * What the runs are called after.
 */
name: string, 
/**
 * Seed of the first user.
 */
seed: number, 
/**
 * How many users, of seeds in a row.
 */
users: number, 
/**
 * When to stop: `plateau`, `off` or a share of successful episodes such as `0.95`.
 */
until: string, 
/**
 * After this many control steps in any case; the default without.
 */
steps: number | null, 
/**
 * Name of the run whose user goes on learning; a new user without.
 */
from: string | null, 
/**
 * Whether it goes on whenever the task is changed: its run is that of the last task.
 */
live: boolean, 
/**
 * Settings of the learner that are not as they come.
 */
settings: Record<string, unknown>, };

/**
 * What episodes fail at most.
 */
export type Bottleneck = { 
/**
 * Number of the step, from 0.
 */
step: number, 
/**
 * Share of the episodes that come to it and do it.
 */
success: number, };

/**
 * How a user does a task that it has not adapted to.
 */
export type Before = { 
/**
 * Share of fresh episodes that succeed.
 */
success: number | null, 
/**
 * Mean duration of an episode (s).
 */
episode_s: number | null, };

/**
 * What a doubling of the practice brought.
 */
export type Doubling = { 
/**
 * Change of the share of episodes that succeed.
 */
success: number, 
/**
 * Change of the duration of an episode, as a share of it.
 */
episode_time: number, 
/**
 * Whether nothing improves any more that is worth further practice.
 */
is_plateau: boolean, };

/**
 * How far a training is.
 */
export type JobProgress = { 
/**
 * Control steps of all environments.
 */
env_steps: number, 
/**
 * Where it ends in any case.
 */
limit: number, 
/**
 * Time since it began (s), pauses aside.
 */
wall_s: number, 
/**
 * Control steps per second lately.
 */
rate: number, 
/**
 * Share of recent training episodes that succeed, whose actions are noisy.
 */
success: number | null, 
/**
 * Mean duration of recent episodes (s).
 */
episode_s: number | null, 
/**
 * Mean squared control of recent episodes.
 */
effort: number | null, 
/**
 * Share of recent episodes in which each step is done.
 */
step_success: Array<number>, 
/**
 * Time that is left, in words, judged by what was learnt so far.
 */
left: string, 
/**
 * What recent episodes fail at most.
 */
bottleneck: Bottleneck | null, 
/**
 * How the user did this task before it learned it, where it comes from another.
 */
before: Before | null, 
/**
 * What the last doubling of the practice brought, once that can be told.
 */
doubling: Doubling | null, 
/**
 * What the body is trained on: `cpu`, or the name of a graphics card.
 */
device: string, 
/**
 * Number of environments.
 */
environments: number, };

/**
 * How a training stands.
 */
export type JobState = { "is": "waiting" } | { "is": "preparing" } | { "is": "training" } | { "is": "paused" } | { "is": "evaluating" } | { "is": "done", 
/**
 * Why: `until`, `plateau` or `steps`.
 */
by: string, 
/**
 * Share of fresh episodes that succeed.
 */
success: number | null, 
/**
 * Mean duration of an episode (s).
 */
episode_s: number | null, } | { "is": "stopped" } | { "is": "failed", 
/**
 * Why.
 */
message: string, };

/**
 * A training.
 */
export type Job = { 
/**
 * Its number.
 */
id: number, 
/**
 * Name of its run, once it has one.
 */
run: string | null, 
/**
 * What it is called.
 */
title: string, 
/**
 * Seed of the user.
 */
seed: number, 
/**
 * Whether it goes on whenever the task is changed.
 */
live: boolean, 
/**
 * How it stands.
 */
state: JobState, 
/**
 * How far it is, once it has begun.
 */
progress: JobProgress | null, 
/**
 * What is worth a word, latest last.
 */
news: Array<string>, };

/**
 * What a training is told to do.
 */
export type Step = "pause" | "resume" | "stop" | "dismiss";

/**
 * A setting of the learner.
 */
export type LearnerSetting = { 
/**
 * Its name.
 */
name: string, 
/**
 * What it says of itself.
 */
about: string, 
/**
 * What it is where nobody changes it.
 */
default: number | number[] | boolean, 
/**
 * What is allowed, in words; none for a switch.
 */
range: string | null, };

/**
 * A term of the reward: a weight times something that is counted.
 */
export type RewardTerm = { 
/**
 * Path of its weight in the task, such as `reward.distance_cost`.
 */
path: string, 
/**
 * The weight.
 */
weight: number, 
/**
 * What is multiplied by it, for people.
 */
of: string, 
/**
 * Whether it is subtracted.
 */
is_cost: boolean, 
/**
 * Least and greatest value in one control step; none where there is no bound.
 */
step: [number | null, number | null], 
/**
 * Least and greatest sum over an episode; none where there is no bound.
 */
episode: [number | null, number | null], };

/**
 * The reward of a task as a sum.
 */
export type RewardView = { 
/**
 * What is summed up.
 */
terms: Array<RewardTerm>, 
/**
 * Least and greatest sum over an episode; none where there is no bound.
 */
episode: [number | null, number | null], 
/**
 * Control steps of the longest episode.
 */
control_steps: number, };

/**
 * From where the reward is looked at.
 */
export type Cut = "front" | "side" | "above";

/**
 * The reward over a rectangle through the object of a step: what distance and time are worth per second to a pointer that stays there.
 */
export type RewardMap = { 
/**
 * A corner (m).
 */
corner: [number, number, number], 
/**
 * From it along a row (m).
 */
along: [number, number, number], 
/**
 * From it from row to row (m).
 */
across: [number, number, number], 
/**
 * Places in a row.
 */
columns: number, 
/**
 * Rows.
 */
rows: number, 
/**
 * Reward per second, row by row.
 */
values: Array<number>, };

/**
 * What people wrote down about a run.
 */
export type RunNote = { 
/**
 * A few words to find it by.
 */
tags: Array<string>, 
/**
 * Free text.
 */
note: string, };

/**
 * What is known of a run.
 */
export type RunStanding = { "is": "readable", 
/**
 * Names of the layouts, one or more.
 */
layouts: Array<string>, 
/**
 * Seed of the training.
 */
seed: number, 
/**
 * What computed the physics: `cpu`, or the name of a graphics card.
 */
device: string, 
/**
 * Control steps up to the newest checkpoint.
 */
env_steps: number, 
/**
 * `training`, `stopped` or `evaluated`.
 */
state: string, 
/**
 * Share of fresh episodes that succeed.
 */
success: number | null, 
/**
 * Mean duration of an episode (s).
 */
episode_s: number | null, 
/**
 * Mean squared control.
 */
effort: number | null, 
/**
 * Share of the strength of all muscles that fatigues in an episode.
 */
fatigue: number | null, 
/**
 * When it was last written to (s since 1970).
 */
changed_s: number, } | { "is": "damaged", 
/**
 * Why.
 */
message: string, };

/**
 * A run in a list.
 */
export type RunEntry = { 
/**
 * The path of its folder below that of all runs.
 */
name: string, 
/**
 * What is known of it.
 */
standing: RunStanding, 
/**
 * What people wrote down.
 */
note: RunNote, };

/**
 * A row of the metrics of a training.
 */
export type CurvePoint = { 
/**
 * Control steps of all environments.
 */
env_steps: number, 
/**
 * Time since the training began (s).
 */
wall_s: number, 
/**
 * Share of the episodes that succeeded; none before one ended.
 */
success: number | null, 
/**
 * Mean duration of an episode (s).
 */
episode_s: number | null, 
/**
 * Mean squared control.
 */
effort: number | null, 
/**
 * Mean sum of rewards.
 */
reward: number | null, };

/**
 * How well a step is done.
 */
export type TargetResult = { 
/**
 * For people.
 */
label: string, 
/**
 * Share of the episodes in which it is done.
 */
success: number, 
/**
 * Mean movement time (s), without dwell.
 */
movement_time_s: number | null, 
/**
 * 95 % confidence interval of it.
 */
movement_time_interval: [number, number] | null, 
/**
 * Mean time with dwell (s).
 */
time_s: number | null, };

/**
 * What users answered to a protocol.
 */
export type ProtocolAnswer = { 
/**
 * Name of the protocol, or `bands`.
 */
name: string, 
/**
 * The answer as text, in columns.
 */
text: string, 
/**
 * Its plot as SVG, if it has one.
 */
plot: string | null, };

/**
 * All that is known of a run.
 */
export type RunDetail = { 
/**
 * The run in the list.
 */
entry: RunEntry, 
/**
 * Text of its task.
 */
text: string, 
/**
 * Name of the body.
 */
model: string, 
/**
 * What its learning was like.
 */
curve: Array<CurvePoint>, 
/**
 * Each step on fresh episodes, in the order of the script; empty before it is evaluated.
 */
targets: Array<TargetResult>, 
/**
 * Episodes that were counted.
 */
episodes: number, 
/**
 * 95 % confidence interval of the success.
 */
success_interval: [number, number] | null, 
/**
 * 95 % confidence interval of the duration of an episode (s).
 */
episode_s_interval: [number, number] | null, 
/**
 * 95 % confidence interval of the effort.
 */
effort_interval: [number, number] | null, 
/**
 * Control steps of the checkpoints that are kept, newest first.
 */
checkpoints: Array<number>, 
/**
 * What its user, and others with other seeds, answered when they were asked what people were asked (`myo eval --protocol`).
 */
protocols: Array<ProtocolAnswer>, };

/**
 * A mean over users.
 */
export type Mean = { 
/**
 * The mean.
 */
mean: number, 
/**
 * Range that holds the mean of all possible users with 95 % confidence; none with a single user.
 */
interval: [number, number] | null, };

/**
 * A step of a layout, over users.
 */
export type StepRow = { 
/**
 * For people.
 */
label: string, 
/**
 * Share of fresh episodes in which it is done.
 */
success: Mean | null, 
/**
 * Mean movement time (s), without dwell.
 */
movement_time_s: Mean | null, };

/**
 * A user of a layout.
 */
export type UserRow = { 
/**
 * Name of the run.
 */
run: string, 
/**
 * Seed of the training.
 */
seed: number, 
/**
 * Share of fresh episodes that succeed.
 */
success: number | null, 
/**
 * Mean duration of an episode (s).
 */
episode_s: number | null, 
/**
 * Mean squared control.
 */
effort: number | null, 
/**
 * Share of the strength of all muscles that fatigues in an episode.
 */
fatigue: number | null, };

/**
 * A quantity of two layouts.
 */
export type Contrast = { 
/**
 * `success`, `episode_length_s`, `effort` or `fatigue`.
 */
quantity: string, 
/**
 * This layout less the first.
 */
difference: number, 
/**
 * 95 % confidence interval of it; none with a single user.
 */
interval: [number, number] | null, 
/**
 * `higher`, `lower`, `within_training`, `no_difference` or `unknown`.
 */
verdict: string, };

/**
 * A layout against the first.
 */
export type Against = { 
/**
 * Success, time, effort and fatigue, as far as both have them.
 */
contrasts: Array<Contrast>, 
/**
 * What can be said, for people.
 */
sentences: Array<string>, 
/**
 * What weakens that, for people.
 */
caveats: Array<string>, };

/**
 * A layout and those who learnt it.
 */
export type LayoutRow = { 
/**
 * What people call it.
 */
name: string, 
/**
 * Who learnt it, at least one.
 */
users: Array<UserRow>, 
/**
 * Share of fresh episodes that succeed, over users.
 */
success: Mean | null, 
/**
 * Mean duration of an episode (s), over users.
 */
episode_s: Mean | null, 
/**
 * Mean squared control, over users.
 */
effort: Mean | null, 
/**
 * Share of the strength of all muscles that fatigues in an episode, over users.
 */
fatigue: Mean | null, 
/**
 * Each step, in the order of the script.
 */
steps: Array<StepRow>, 
/**
 * How it differs from the first layout; none for the first.
 */
against: Against | null, };

/**
 * A run that is in no row.
 */
export type LeftOut = { 
/**
 * Its name.
 */
run: string, 
/**
 * Why.
 */
reason: string, };

/**
 * Layouts, each with its users.
 */
export type LayoutTable = { 
/**
 * A row for each, in the order in which their first runs were named.
 */
layouts: Array<LayoutRow>, 
/**
 * Runs that nothing can be said of.
 */
left_out: Array<LeftOut>, };

/**
 * Users of a task as it is.
 */
export type LayoutUsers = { 
/**
 * Names of the runs of those who have learnt it and are tested, each of another seed.
 */
runs: Array<string>, 
/**
 * Numbers of the trainings of those who learn it or wait for that.
 */
on_the_way: Array<number>, };

/**
 * A motion in text.
 */
export type RecordedMotion = { 
/**
 * How its numbers lie.
 */
header: MotionHeader, 
/**
 * The numbers in single precision, little end first, in base 64.
 */
numbers: string, };

/**
 * A run in a report.
 */
export type RecordedRun = { 
/**
 * All that is known of it.
 */
detail: RunDetail, 
/**
 * Its task, written out.
 */
view: TaskView, 
/**
 * Its body.
 */
body: BodyShape, 
/**
 * Mean squared control of each step; empty for a run without a checkpoint.
 */
efforts: Array<number | null>, 
/**
 * An episode; none for a run without a checkpoint.
 */
motion: RecordedMotion | null, };

/**
 * Runs as they were when the report was made.
 */
export type Recorded = { 
/**
 * Version of Myo.
 */
version: string, 
/**
 * When it was made (s since 1970).
 */
made_s: number, 
/**
 * Each run, in the order in which they were named.
 */
runs: Array<RecordedRun>, 
/**
 * All of them by layout.
 */
table: LayoutTable, };

/**
 * Why something cannot be done: one sentence, and what it is about where that is known.
 */
export type Refusal = { 
/**
 * For people.
 */
message: string, 
/**
 * What is wrong in the text of a task.
 */
findings: Array<Finding>, };

/**
 * What happens by itself.
 */
export type Event = { "event": "jobs", 
/**
 * All of them.
 */
jobs: Array<Job>, } | { "event": "runs" } | { "event": "tasks", 
/**
 * Its name; none where it may be any.
 */
name: string | null, };

/**
 * What an engine is and has.
 */
export type Welcome = { 
/**
 * Version of Myo.
 */
version: string, 
/**
 * Where tasks and runs are kept, for people.
 */
folder: string, 
/**
 * Threads of the processor.
 */
threads: number, 
/**
 * Tasks that come with it.
 */
presets: Array<PresetCard>, 
/**
 * Bodies that come with it.
 */
models: Array<string>, };

/**
 * The first moment of a task, which comes as a motion of one frame.
 */
export type Pose = { 
/**
 * Text of the task.
 */
text: string, };

/**
 * An episode of a run, which comes as a motion.
 */
export type Replay = { 
/**
 * Name of the run.
 */
run: string, 
/**
 * Seed of the episode; episodes of one seed are the same whatever user does them.
 */
seed: number, 
/**
 * Control steps of the checkpoint; the newest without.
 */
env_steps: number | null, };

/**
 * What this engine is and has.
 */
export type Hello = Record<symbol, never>;

/**
 * The JSON Schema of task files: fields with explanation, default and range.
 */
export type AskSchema = Record<symbol, never>;

/**
 * What stands in the text of a task and what is wrong with it, reach aside.
 */
export type LookAt = { 
/**
 * The text.
 */
text: string, };

/**
 * The text of a task in the newest version of the format, without its comments.
 */
export type ConvertTask = { 
/**
 * The text.
 */
text: string, };

/**
 * Everything wrong or odd about a task, reach included.
 */
export type CheckTask = { 
/**
 * The text.
 */
text: string, };

/**
 * What the pointer of a task can reach.
 */
export type AskReach = { 
/**
 * The text.
 */
text: string, };

/**
 * What a task is rewarded for, with the least and the greatest value of each term.
 */
export type AskReward = { 
/**
 * The text.
 */
text: string, };

/**
 * The reward over a rectangle through the object of a step.
 */
export type AskRewardMap = { 
/**
 * The text.
 */
text: string, 
/**
 * Number of the step, from 0.
 */
step: number, 
/**
 * How the rectangle lies.
 */
cut: Cut, };

/**
 * All settings of the learner.
 */
export type AskSettings = Record<symbol, never>;

/**
 * The body of a task's user.
 */
export type AskBody = { 
/**
 * Name or file of the model.
 */
model: string, 
/**
 * What its user changes of it.
 */
body: unknown, };

/**
 * The body that learnt in a run, whatever became of the file of its model.
 */
export type AskBodyOfRun = { 
/**
 * Name of the run.
 */
name: string, };

/**
 * Task files that were kept.
 */
export type ListTasks = Record<symbol, never>;

/**
 * Opens a task that was kept.
 */
export type OpenTask = { 
/**
 * Its name.
 */
name: string, };

/**
 * Keeps a task.
 */
export type SaveTask = { 
/**
 * Its name: that of the file without its ending.
 */
name: string, 
/**
 * The text.
 */
text: string, };

/**
 * Puts a task into the bin.
 */
export type DiscardTask = { 
/**
 * Its name.
 */
name: string, };

/**
 * Trains a user, once those before it are done.
 */
export type Train = { 
/**
 * What and how.
 */
order: JobOrder, };

/**
 * Takes a run up again that was stopped, whoever trained there.
 */
export type GoOn = { 
/**
 * Name of the run.
 */
run: string, };

/**
 * Goes on with a training on another task, or with other settings: its user keeps what it has learnt.
 */
export type Relearn = { 
/**
 * Which one.
 */
job: number, 
/**
 * Text of the task.
 */
text: string, 
/**
 * Settings of the learner that are not as they come; none leaves them as they are.
 */
settings: Record<string, unknown> | null, };

/**
 * Tells a training what to do next.
 */
export type TellJob = { 
/**
 * Which one.
 */
job: number, 
/**
 * What to do.
 */
step: Step, };

/**
 * Chooses the training whose movement comes as motions; none for none.
 */
export type Watch = { 
/**
 * Which one.
 */
job: number | null, };

/**
 * All runs.
 */
export type ListRuns = Record<symbol, never>;

/**
 * All that is known of a run.
 */
export type AskRun = { 
/**
 * Its name: the path of its folder below that of all runs.
 */
name: string, };

/**
 * Mean squared control of each step of a run over some fresh episodes; null for steps that no episode comes to.
 */
export type AskEfforts = { 
/**
 * Its name.
 */
name: string, };

/**
 * Runs by what their users learnt, with what tells the layouts apart.
 */
export type CompareRuns = { 
/**
 * Names of the runs; the layout of the first is what others are held against.
 */
names: Array<string>, };

/**
 * Who has learnt a task as it is from nothing, with the settings as they come, and who is about to.
 */
export type AskUsersOf = { 
/**
 * Text of the task.
 */
text: string, 
/**
 * When they stop: `plateau`, `off` or a share of successful episodes.
 */
until: string, };

/**
 * A report on runs as one page (HTML) that needs nothing else.
 */
export type AskReport = { 
/**
 * Names of the runs.
 */
names: Array<string>, };

/**
 * Writes tags and a note down beside a run.
 */
export type NoteRun = { 
/**
 * Name of the run.
 */
name: string, 
/**
 * What to write down.
 */
note: RunNote, };

/**
 * Gives a run another name.
 */
export type RenameRun = { 
/**
 * Its name.
 */
name: string, 
/**
 * What it is to be called.
 */
to: string, };

/**
 * Puts a run into the bin.
 */
export type DiscardRun = { 
/**
 * Its name.
 */
name: string, };

export const MOMENT = 10;
export const PART = 7;
export const OBJECT = 12;

/** Everything that can be asked: what goes with it and what comes back. */
export interface Calls {
  hello: { with: Hello; reply: Welcome };
  schema: { with: AskSchema; reply: unknown };
  look: { with: LookAt; reply: Look };
  convert: { with: ConvertTask; reply: string };
  check: { with: CheckTask; reply: Array<Finding> };
  reach: { with: AskReach; reply: Surface };
  reward: { with: AskReward; reply: RewardView };
  reward_map: { with: AskRewardMap; reply: RewardMap };
  settings: { with: AskSettings; reply: Array<LearnerSetting> };
  body: { with: AskBody; reply: BodyShape };
  body_of_run: { with: AskBodyOfRun; reply: BodyShape };
  tasks: { with: ListTasks; reply: Array<TaskFile> };
  open: { with: OpenTask; reply: TaskText };
  save: { with: SaveTask; reply: TaskFile };
  discard_task: { with: DiscardTask; reply: null };
  train: { with: Train; reply: Array<number> };
  go_on: { with: GoOn; reply: number };
  relearn: { with: Relearn; reply: null };
  tell: { with: TellJob; reply: null };
  watch: { with: Watch; reply: null };
  runs: { with: ListRuns; reply: Array<RunEntry> };
  run: { with: AskRun; reply: RunDetail };
  efforts: { with: AskEfforts; reply: Array<number | null> };
  compare: { with: CompareRuns; reply: LayoutTable };
  users_of: { with: AskUsersOf; reply: LayoutUsers };
  report: { with: AskReport; reply: string };
  note: { with: NoteRun; reply: null };
  rename_run: { with: RenameRun; reply: null };
  discard_run: { with: DiscardRun; reply: null };
}
