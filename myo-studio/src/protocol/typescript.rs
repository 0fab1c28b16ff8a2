//! The protocol as types of the page, `web/src/engine/protocol.ts`. `MYO_BLESS=1` writes it anew.

use std::path::Path;

use ts_rs::{Config, TS};

use super::*;

/// Declarations of these types, each with what it says of itself.
macro_rules! declarations {
    ($config:ident; $($kind:ty)*) => {
        [$(declaration::<$kind>(&$config)),*].concat()
    };
}

fn declaration<T: TS>(config: &Config) -> String {
    let docs = T::docs().unwrap_or_default();
    format!("{docs}export {}\n\n", T::decl(config))
}

fn calls() -> String {
    let line = |call: &Call| format!("  {}: {{ with: {}; reply: {} }};\n", call.name, call.with, call.reply);
    let lines: String = CALLS.iter().map(line).collect();
    format!(
        "/** Everything that can be asked: what goes with it and what comes back. */\nexport interface Calls {{\n{lines}}}\n"
    )
}

fn page() -> String {
    let config = Config::new().with_large_int("number");
    let types = declarations! { config;
        Severity Finding ObjectKind ObjectView StepView ItemView TaskView Look PresetCard TaskFile TaskText Surface
        BodyPart LookShape BoneShape DigitShape MuscleShape BodyShape MotionLayout MotionHeader
        JobOrder Bottleneck Before Doubling JobProgress JobState Job Step LearnerSetting
        RewardTerm RewardView Cut RewardMap
        RunNote RunStanding RunEntry CurvePoint TargetResult ProtocolAnswer RunDetail
        Mean StepRow UserRow Contrast Against LayoutRow LeftOut LayoutTable LayoutUsers RecordedMotion RecordedRun Recorded
        Refusal Event Welcome Pose Replay
        Hello AskSchema LookAt ConvertTask CheckTask AskReach AskReward AskRewardMap AskSettings AskBody AskBodyOfRun ListTasks OpenTask SaveTask DiscardTask Train GoOn Relearn TellJob Watch ListRuns
        AskRun AskEfforts CompareRuns AskUsersOf AskReport NoteRun RenameRun DiscardRun
    };
    let sizes =
        format!("export const MOMENT = {MOMENT};\nexport const PART = {PART};\nexport const OBJECT = {OBJECT};\n");
    format!("// Written from myo-studio/src/protocol; its tests say how.\n\n{types}{sizes}\n{}", calls())
}

#[test]
fn the_page_has_the_types_of_this_protocol() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("web/src/engine/protocol.ts");
    let page = page();
    if std::env::var_os("MYO_BLESS").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(written == page, "{} is out of date; run this test with MYO_BLESS=1", path.display());
}
