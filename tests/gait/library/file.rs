//! The library's file gives back what was written and refuses what is damaged.

use crate::common::glb;
use gaitway::Emotion;
use gaitway::gait::walker::Sex;
use gaitway::gait::{Gait, Joint, LabelOrigin, Provenance};
use gaitway::library::{DEFAULT_PER_CLASS, DEFAULT_SEED, Error, GaitLibrary, MOST_PER_CLASS};
use glam::Vec3;
use std::path::Path;

fn small() -> GaitLibrary {
    let mut gaits = GaitLibrary::generated(3, 1).unwrap().gaits().to_vec();
    gaits[0].ratings = Some([4.7, 1.1, 1.0 / 3.0 + 1.0, 2.05]);
    gaits[1].label = None;
    gaits[1].provenance = Provenance::default();
    gaits[1].acted = None;
    gaits[2].name = "\"quoted\" \u{e9}\\n".to_owned();
    gaits[2].poses[3][5] = Vec3::new(-0.0, f32::MIN_POSITIVE / 2.0, 0.1 + 0.2);
    gaits[3].poses.truncate(17);
    gaits[3].frame_rate = 29.97;
    GaitLibrary::from_gaits(gaits).unwrap()
}

/// All numbers of a library as bits: 0 and -0 differ.
fn bits(library: &GaitLibrary) -> Vec<u32> {
    let numbers = library.gaits().iter().flat_map(|gait| {
        let positions = gait.poses.iter().flatten().flat_map(Vec3::to_array);
        positions.chain([gait.frame_rate, gait.speed]).chain(gait.ratings.into_iter().flatten())
    });
    numbers.map(f32::to_bits).collect()
}

#[test]
fn a_library_read_back_is_the_library_written() {
    let library = small();
    let back = GaitLibrary::from_glb_bytes(&library.to_glb_bytes(), "test").unwrap();
    assert_eq!(back, library);
    assert_eq!(bits(&back), bits(&library));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("library.glb");
    library.save_glb(&path).unwrap();
    assert_eq!(GaitLibrary::load_glb(&path).unwrap(), library);
    let names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names, ["library.glb"], "nothing else is left behind");
    let empty = GaitLibrary::from_gaits(Vec::new()).unwrap();
    assert_eq!(GaitLibrary::from_glb_bytes(&empty.to_glb_bytes(), "empty").unwrap(), empty);
}

#[test]
fn a_file_tells_whose_judgement_each_label_is() {
    let mut gaits = GaitLibrary::generated(4, 1).unwrap().gaits().to_vec();
    gaits[0].set_predicted(Emotion::Sad, "affective-svm (p 0.80)");
    gaits[0].set_predicted(Emotion::Angry, "affective-svm (p 0.90)");
    gaits[1].provenance.label_origin = Some(LabelOrigin::Rated);
    (gaits[2].label, gaits[2].provenance.label_origin) = (None, None);
    let library = GaitLibrary::from_gaits(gaits).unwrap();
    let read = GaitLibrary::from_glb_bytes(&library.to_glb_bytes(), "memory").unwrap();
    assert_eq!(read, library);
    let origins: Vec<_> = read.gaits()[..5].iter().map(|gait| gait.provenance.label_origin).collect();
    let [rated, predicted, generated] =
        [LabelOrigin::Rated, LabelOrigin::Predicted, LabelOrigin::Generated].map(Some);
    assert_eq!(origins, [predicted, rated, None, generated, generated]);
    assert_eq!(read.gaits()[0].label, Some(Emotion::Angry));
    assert_eq!(read.gaits()[0].provenance.label_model.as_deref(), Some("affective-svm (p 0.90)"));
    let text = String::from_utf8_lossy(&library.to_glb_bytes()).matches("\"label_origin\":\"rated\"").count();
    assert_eq!(text, 1, "the file says it in a field of its own");
}

#[test]
fn the_default_library_is_what_the_program_generates() {
    let generated = GaitLibrary::generated(DEFAULT_SEED, DEFAULT_PER_CLASS).unwrap();
    if std::env::var_os("GAITWAY_UPDATE_ASSETS").is_some() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/gaits/default.glb");
        GaitLibrary::write_default(&path).unwrap();
        println!("written: {}; build again", path.display());
        return;
    }
    let built_in = GaitLibrary::built_in().expect("run the tests once with GAITWAY_UPDATE_ASSETS=1");
    let again = GaitLibrary::from_glb_bytes(&built_in.to_glb_bytes(), "written again").unwrap();
    assert_eq!(bits(&again), bits(&built_in), "an older version wrote the file");
    assert_eq!(again, built_in);
    assert_eq!(built_in.gaits().len(), generated.gaits().len());
    for (stored, made) in built_in.gaits().iter().zip(generated.gaits()) {
        assert_eq!((&stored.name, stored.label), (&made.name, made.label));
        assert_eq!(
            stored.provenance, made.provenance,
            "raise walker::VERSION and set GAITWAY_UPDATE_ASSETS=1"
        );
        assert!((stored.speed - made.speed).abs() < 1e-6);
        for (a, b) in stored.poses.iter().flatten().zip(made.poses.iter().flatten()) {
            assert!(a.distance(*b) < 1e-5, "{}: {a} is generated as {b}", stored.name);
        }
    }
    if bits(&built_in) != bits(&generated) {
        println!("note: not equal to the last bit on this machine");
    }
}

#[test]
fn the_file_plays_in_a_viewer_as_the_gaits_are() {
    let library = GaitLibrary::generated(8, 1).unwrap();
    let bytes = library.to_glb_bytes();
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes).unwrap();
    assert_eq!(document.animations().count(), 8);
    assert_eq!(document.skins().next().unwrap().joints().count(), 16);
    for (animation, gait) in document.animations().zip(library.gaits()) {
        let mut local: Vec<(Vec3, glam::Quat, f32)> = document
            .nodes()
            .take(16)
            .map(|node| (Vec3::from(node.transform().decomposed().0), glam::Quat::IDENTITY, 1.0))
            .collect();
        let frame = 11;
        for channel in animation.channels() {
            let node = &mut local[channel.target().node().index()];
            let reader = channel.reader(|_| blob.as_deref());
            match reader.read_outputs().unwrap() {
                gltf::animation::util::ReadOutputs::Translations(mut values) => {
                    node.0 = Vec3::from(values.nth(frame).unwrap());
                }
                gltf::animation::util::ReadOutputs::Rotations(values) => {
                    node.1 = glam::Quat::from_array(values.into_f32().nth(frame).unwrap());
                }
                gltf::animation::util::ReadOutputs::Scales(mut values) => node.2 = values.next().unwrap()[0],
                gltf::animation::util::ReadOutputs::MorphTargetWeights(_) => panic!("no morph targets"),
            }
        }
        let mut world = [glam::Mat4::IDENTITY; 16];
        for joint in 0..16 {
            let (translation, rotation, scale) = local[joint];
            assert!(rotation.is_normalized() || (rotation.length() - 1.0).abs() < 1e-3);
            let here = glam::Mat4::from_scale_rotation_translation(Vec3::splat(scale), rotation, translation);
            world[joint] = if joint == 0 { here } else { world[Joint::PARENT[joint]] * here };
            let off = world[joint].w_axis.truncate().distance(gait.poses[frame][joint]);
            assert!(off < 0.05, "{}: {:?} is drawn {off} m off", gait.name, Joint::ALL[joint]);
        }
    }
}

#[test]
fn gea_lists_each_emotion_and_choosing_is_uniform() {
    let library = small();
    assert_eq!(library.counts(), [1, 2, 2, 2]);
    let (starts, ids) = library.association();
    assert_eq!((starts, ids), (&[0, 1, 3, 5, 7], &[0, 2, 3, 4, 5, 6, 7][..]));
    let library = GaitLibrary::built_in().unwrap();
    assert_eq!(library.counts(), [12; 4]);
    let mut hits = vec![0_u32; library.gaits().len()];
    for i in 0..48_000_u32 {
        let random = i.wrapping_mul(0x9e37_79b9);
        for sex in [None, Some(Sex::Female)] {
            let id = library.choose(Emotion::Sad, sex, random).unwrap();
            let gait = &library.gaits()[id as usize];
            assert_eq!(gait.label, Some(Emotion::Sad));
            assert!(sex.is_none() || gait.provenance.sex == sex);
            hits[id as usize] += u32::from(sex.is_none());
        }
    }
    let sad = library.gaits_for(Emotion::Sad);
    assert!(sad.iter().all(|&id| (3_900..4_100).contains(&hits[id as usize])), "{hits:?}");
}

#[test]
fn choosing_falls_back_to_any_sex_and_says_when_an_emotion_has_no_gait() {
    let sad_men = GaitLibrary::generated(1, 2).unwrap().gaits()[10..12].to_vec();
    let library = GaitLibrary::from_gaits(sad_men).unwrap();
    assert!(library.choose(Emotion::Sad, Some(Sex::Female), 7).is_ok());
    let message = library.choose(Emotion::Happy, None, 7).unwrap_err().to_string();
    assert!(message.contains("happy") && message.contains("sad 2"), "{message}");
}

#[test]
fn unusable_gaits_are_refused_with_the_value() {
    let good = GaitLibrary::generated(1, 1).unwrap().gaits()[0].clone();
    let refused = |change: &dyn Fn(&mut Gait)| {
        let mut gait = good.clone();
        change(&mut gait);
        GaitLibrary::from_gaits(vec![gait]).unwrap_err().to_string()
    };
    assert!(refused(&|gait| gait.poses[5][3].y = f32::NAN).contains("frame 5, head: position"));
    assert!(refused(&|gait| gait.poses[0][0].x = 170.0).contains("170"));
    assert!(refused(&|gait| gait.poses.clear()).contains("0 frames"));
    assert!(refused(&|gait| gait.frame_rate = 0.0).contains("is 0"));
    assert!(refused(&|gait| gait.speed = f32::NAN).contains("speed (m/s) is NaN"));
    assert!(refused(&|gait| gait.ratings = Some([0.0, 1.0, 2.0, 3.0])).contains("happy is 0"));
    assert!(refused(&|gait| gait.name.clear()).contains("name"));
    assert!(
        GaitLibrary::from_gaits(vec![good.clone(), good]).unwrap_err().to_string().contains("another gait")
    );
    assert!(matches!(GaitLibrary::generated(1, MOST_PER_CLASS + 1), Err(Error::TooMany { .. })));
}

/// The file with a text in its JSON chunk replaced, lengths put right.
fn edited(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let (json, binary) = glb::parts(bytes);
    let text = String::from_utf8(json).unwrap();
    assert!(text.contains(from), "{from} is not in the file");
    glb::file(text.replacen(from, to, 1), binary)
}

fn message_of(bytes: &[u8]) -> String {
    GaitLibrary::from_glb_bytes(bytes, "broken.glb").unwrap_err().to_string()
}

#[test]
fn damaged_files_are_refused_with_what_was_found() {
    let bytes = small().to_glb_bytes();
    assert!(message_of(b"").contains("not a GLB file"));
    assert!(message_of(&bytes[..bytes.len() - 1]).contains("cut off"));
    assert!(message_of(&edited(&bytes, "\"version\":2,", "\"version\":1,")).contains("library version 1"));
    assert!(message_of(&edited(&bytes, "gaitway-gait-library", "somebody-elses")).contains("somebody-elses"));
    assert!(
        message_of(&edited(&bytes, "\"left_knee\",\"left_foot\"", "\"left_foot\",\"left_knee\""))
            .contains("joints")
    );
    assert!(message_of(&edited(&bytes, "\"positions\":0,", "\"positions\":999999,")).contains("999999"));
    assert!(message_of(&edited(&bytes, "\"count\":1024,", "\"count\":1023,")).contains("1023"));
    assert!(
        message_of(&edited(&bytes, "\"count\":1024,", "\"count\":18446744073709551600,"))
            .contains("1844674407")
    );
    assert!(
        message_of(&edited(&bytes, "\"count\":1024,", "\"count\":160000,")).contains("need 1920000 bytes")
    );
    assert!(message_of(&edited(&bytes, "\"label\":\"happy\"", "\"label\":\"merry\"")).contains("merry"));
    assert!(message_of(&edited(&bytes, "\"speed\":", "\"speed\":-")).contains("speed"));
    let missing = GaitLibrary::load_glb("nowhere.glb").unwrap_err().to_string();
    assert!(missing.contains("nowhere.glb"), "{missing}");
    let failed = small().save_glb("nowhere/at/all.glb").unwrap_err().to_string();
    assert!(failed.contains("nowhere/at/all.glb"), "{failed}");
}

#[test]
fn positions_that_are_not_numbers_are_refused() {
    let bytes = small().to_glb_bytes();
    let (json, mut binary) = glb::parts(&bytes);
    binary[..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let bad = glb::file(json, binary);
    assert!(message_of(&bad).contains("frame 0, root"), "{}", message_of(&bad));
}

#[test]
fn one_block_of_positions_cannot_serve_many_gaits() {
    let bytes = small().to_glb_bytes();
    let first = "\"positions\":0,";
    let text = String::from_utf8(glb::parts(&bytes).0).unwrap();
    let mut file = bytes.clone();
    for part in text.split("\"positions\":").skip(2) {
        let number = part.split(',').next().unwrap();
        file = edited(&file, &format!("\"positions\":{number},"), first);
    }
    // Small enough to fit the file as a whole is allowed; that it is bounded is what matters.
    let _ = GaitLibrary::from_glb_bytes(&file, "shared");
    let many = "{\"channels\":[],\"samplers\":[],\"name\":\"x\",\"extras\":{\"gaitway\":{\"positions\":0,\"frame_rate\":60,\
                \"speed\":1}}},"
        .repeat(200);
    let file = edited(&bytes, "\"animations\":[", &format!("\"animations\":[{many}"));
    let message = message_of(&file);
    assert!(message.contains("shared with another") || message.contains("glTF"), "{message}");
}

#[test]
fn mutated_files_never_panic() {
    let original = GaitLibrary::from_gaits(small().gaits()[..2].to_vec()).unwrap().to_glb_bytes();
    let length = u32::from_le_bytes(original[12..16].try_into().unwrap()) as usize;
    let mut state = 0x1234_5678_9abc_def1_u64;
    let mut random = |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as usize % below
    };
    let tokens: [&[u8]; 9] =
        [b"-1", b"99999999999", b"null", b"{}", b"[]", b"\"\"", b"1e999", b"glTF", b"\xff\xfe"];
    let mut accepted = 0;
    for round in 0..3000 {
        let mut bytes = original.clone();
        for _ in 0..=random(3) {
            // Half of the changes hit the header and the JSON, where the structure is.
            let at =
                if round % 4 == 0 { random(bytes.len()) } else { random(28 + length).min(bytes.len() - 1) };
            match random(5) {
                0 => bytes[at] ^= 1 << random(8),
                1 => bytes[at] = b"0123456789-{}[],:\"e."[random(20)],
                2 => bytes.truncate(at.max(1)),
                3 => {
                    let token = tokens[random(tokens.len())];
                    let end = (at + token.len()).min(bytes.len());
                    bytes[at..end].copy_from_slice(&token[..end - at]);
                }
                _ => {
                    let from = random(bytes.len());
                    let piece: Vec<u8> = bytes[from..(from + 9).min(bytes.len())].to_vec();
                    let end = (at + piece.len()).min(bytes.len());
                    bytes[at..end].copy_from_slice(&piece[..end - at]);
                }
            }
        }
        if round % 2 == 0 && bytes.len() >= 12 {
            // Let most get past the first check.
            let total = (bytes.len() as u32).to_le_bytes();
            bytes[8..12].copy_from_slice(&total);
        }
        accepted += usize::from(GaitLibrary::from_glb_bytes(&bytes, "mutated").is_ok());
    }
    println!("{accepted} of 3000 mutated files were still libraries");
    assert!(accepted < 2500);
}
