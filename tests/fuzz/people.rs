//! Readers of what people look like and what others see in them: gaits, labels, models, bodies.

use crate::mutate::Form;
use crate::targets::{Target, gait, text, with_files};
use gaitway::Emotion;
use gaitway::avatar::{self, RigMap, Sex, generated};
use gaitway::gait::import::labels::Labels;
use gaitway::gait::{Gait, fit};
use gaitway::perception::affective_svm::AffectiveSvm;
use gaitway::perception::features::Variant;
use gaitway::perception::model::Model;
use gaitway::perception::ratings;
use gaitway::replay::Columns;
use gaitway::scenario::{Area, Shares};
use std::sync::LazyLock;

pub(crate) static TARGETS: [Target; 9] = [
    Target {
        name: "fit-bytes",
        form: Form::Binary,
        seeds: || vec![fit::to_bytes(&fitted())],
        read: |bytes| gaits(fit::from_bytes(bytes, "x")),
    },
    Target {
        name: "fit-json",
        form: Form::Text,
        seeds: || vec![fit::to_json(&fitted()).into_bytes()],
        read: |bytes| gaits(fit::from_json(bytes, "x")),
    },
    Target {
        name: "labels",
        form: Form::Text,
        seeds: || {
            let table = "file,subject,style,perceived_label\na_01.bvh,7,proud,happy\nx/walk1.BVH;8;sad;sad\n";
            vec![table.into(), "name;subject;Emotion\n\nwalk1;anna;happy;\n".into()]
        },
        read: |bytes| {
            with_files(&[("labels.csv", bytes)], |folder| {
                let found = Labels::beside(&[folder.join("walk1.bvh")]).map_err(|error| error.to_string())?;
                Ok(found.unused().len().to_string())
            })
        },
    },
    Target {
        name: "ratings",
        form: Form::Text,
        seeds: || {
            let quoted = "\u{feff}Worker ID;Looks happy?;Anger;Sadness;Neutral;Video;Sex;Age\r\n\
                w1;5;Strongly Disagree;2.0;\"neither agree nor disagree\";gaits/a.1.mp4;Female;34\r\n";
            let plain = "participant,video,happy,angry,sad,neutral\np,v,1,2,3,4\nq,v,1,1,1,5\np,w,5,5,4,1\nq,w,5,4,4,1\n";
            vec![quoted.into(), plain.into()]
        },
        read: |bytes| {
            let options = ratings::Options { skip_bad: true, ..ratings::Options::default() };
            let sheet = ratings::parse(&text(bytes), "x", &options).map_err(|error| error.to_string())?;
            let found = ratings::analyse(&sheet.responses, ratings::THETA);
            Ok(format!("{} {}", sheet.responses.len().min(9), serde_json::to_string(&found).is_ok()))
        },
    },
    Target {
        name: "video-key",
        form: Form::Text,
        seeds: || vec!["video,gait\nclip-001,\"a \"\"b\"\"\"\nclip-002,c\n".into()],
        read: |bytes| {
            let found = ratings::parse_key(&text(bytes), "x").map_err(|error| error.to_string())?;
            Ok(found.len().min(9).to_string())
        },
    },
    Target {
        name: "model",
        form: Form::Text,
        seeds: model_seeds,
        read: |bytes| {
            let model = Model::from_json(&text(bytes), "x").map_err(|error| error.to_string())?;
            let seen = model.predict(&SAD);
            assert!(seen.probabilities.iter().all(|p| p.is_finite()), "{seen:?}");
            Ok(model.describe().len().to_string())
        },
    },
    Target {
        name: "rig-map",
        form: Form::Text,
        seeds: || {
            vec!["avatar = \"hero\"\nheight = 1.7\n[joints]\nroot = \"Bone\"\nneck = \"\"\nleft_knee = \"#7\"\n".into()]
        },
        read: |bytes| {
            let map = RigMap::from_toml("x", &text(bytes)).map_err(|error| error.to_string())?;
            Ok(format!("{:?}", map.height().is_some()))
        },
    },
    Target {
        name: "avatar",
        form: Form::Glb,
        seeds: avatar_seeds,
        read: |bytes| {
            let loaded = avatar::load_bytes("x", bytes, None, &RigMap::default());
            let floor = with_files(&[("a.glb", bytes)], |folder| {
                let triangles = avatar::triangles(&folder.join("a.glb"), None).map_err(|e| e.to_string())?;
                let area = Area::from_triangles(&triangles).map_err(|error| error.to_string())?;
                avatar::model(&folder.join("a.glb")).map_err(|error| error.to_string())?;
                Ok(area.bounds.len().min(9).to_string())
            });
            let loaded = loaded.map_err(|error| format!("{error} {:?} {}", error.hint(), floor.is_ok()))?;
            assert!(loaded.avatar.height.is_finite() && loaded.avatar.eyes_in_head.is_finite());
            Ok(format!("{} {}", loaded.avatar.levels.len(), floor.is_ok()))
        },
    },
    Target {
        name: "words",
        form: Form::Text,
        seeds: || ["happy", "female", "happy=1,sad=2", "id,frame,x,-,y", "paper"].map(Into::into).to_vec(),
        read: |bytes| {
            let word = text(bytes);
            let answers = [
                word.parse::<Emotion>().err().map(|error| error.to_string()),
                word.parse::<gaitway::gait::walker::Sex>().err().map(|error| error.to_string()),
                word.parse::<Shares>().err().map(|error| error.to_string()),
                word.parse::<Columns>().err().map(|error| error.to_string()),
                word.parse::<Variant>().err().map(|error| error.to_string()),
            ];
            let refused: Vec<String> = answers.into_iter().flatten().collect();
            if refused.len() < 5 { Ok(String::new()) } else { Err(refused.concat()) }
        },
    },
];

static SAD: LazyLock<Gait> = LazyLock::new(|| gait(Emotion::Sad, 0));

fn fitted() -> Vec<fit::HarmonicGait> {
    vec![fit::fit(&gait(Emotion::Happy, 1), 1).unwrap()]
}

fn gaits(read: Result<Vec<fit::HarmonicGait>, gaitway::gait::Error>) -> Result<String, String> {
    let gaits = read.map_err(|error| error.to_string())?;
    for gait in &gaits {
        let gait = gait.to_gait(10);
        assert!(gait.poses.iter().flatten().all(|point| point.is_finite()), "a gait that is not finite");
    }
    Ok(gaits.len().min(9).to_string())
}

fn model_seeds() -> Vec<Vec<u8>> {
    let emotions = [Emotion::Happy, Emotion::Sad];
    let gaits = emotions.map(|emotion| gait(emotion, 2));
    let model = AffectiveSvm::default().model(&gaits.each_ref(), &emotions, 1).unwrap();
    vec![model.to_json().unwrap().into_bytes()]
}

/// A body of a few triangles.
fn avatar_seeds() -> Vec<Vec<u8>> {
    let mut small = generated(Sex::Female);
    small.levels.truncate(1);
    let mesh = &mut small.levels[0];
    let kept: Vec<u32> =
        mesh.indices.chunks_exact(3).step_by(mesh.indices.len() / 3 / 12).flatten().copied().collect();
    mesh.vertices = kept.iter().map(|&corner| mesh.vertices[corner as usize]).collect();
    mesh.indices = (0..u32::try_from(kept.len()).unwrap()).collect();
    vec![avatar::glb(&small)]
}
