//! The address at which a platform grants credit when it is opened.

/// Fields that the address of Sona has: of the study, its secret, the participant.
const FIELDS: [&str; 3] = ["experiment_id", "credit_token", PARTICIPANT];
/// The field that takes the participant's code.
const PARTICIPANT: &str = "survey_code";

/// What is wrong with an address of credit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::study) enum CreditFault {
    /// It does not begin with `https://` and a host.
    NoHttps,
    /// It holds what no address holds, or a fragment.
    Characters,
    /// A field is not there once.
    Field(&'static str),
}

/// Reads the address as Sona shows it; returns the part before the participant's code, and the part after it.
pub(in crate::study) fn credit(address: &str) -> Result<(&str, &str), CreditFault> {
    let rest = address.strip_prefix("https://").ok_or(CreditFault::NoHttps)?;
    let is_plain = |c: char| c.is_ascii_graphic() && !"\"'<>\\^`{}|#".contains(c);
    if !address.chars().all(is_plain) {
        return Err(CreditFault::Characters);
    }
    let (place, query) = rest.split_once('?').ok_or(CreditFault::Field(FIELDS[0]))?;
    let host = place.split('/').next().unwrap_or_default();
    if !host.contains('.') || host.contains('@') {
        return Err(CreditFault::NoHttps);
    }
    for field in FIELDS {
        let values = query.split('&').filter_map(|pair| pair.split_once('=')).filter(|pair| pair.0 == field);
        let values: Vec<&str> = values.map(|pair| pair.1).collect();
        if values.len() != 1 || field != PARTICIPANT && values[0].is_empty() {
            return Err(CreditFault::Field(field));
        }
    }
    let marker = format!("{PARTICIPANT}=");
    let begins = |at: &usize| matches!(address.as_bytes().get(at.wrapping_sub(1)), Some(b'?' | b'&'));
    let at = address.match_indices(&marker).map(|(at, _)| at).find(begins);
    let start = at.ok_or(CreditFault::Field(PARTICIPANT))? + marker.len();
    let end = address[start..].find('&').map_or(address.len(), |length| start + length);
    Ok((&address[..start], &address[end..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_as_sona_shows_it_is_taken_and_others_are_refused() {
        let sona = "https://school.sona-systems.com/webstudy_credit.aspx?experiment_id=123&credit_token=9185d4&survey_code=XXXX";
        let (before, after) = credit(sona).unwrap();
        assert_eq!((format!("{before}77{after}"), after), (sona.replace("XXXX", "77"), ""));
        // in any order, and whatever stands in the place of the code
        let other = "https://s.org/c?survey_code=&a_survey_code=1&credit_token=t&experiment_id=5";
        assert_eq!(
            credit(other),
            Ok(("https://s.org/c?survey_code=", "&a_survey_code=1&credit_token=t&experiment_id=5"))
        );
        let wrong = |address: &str| credit(address).unwrap_err();
        assert_eq!(wrong(&sona.replacen("https", "http", 1)), CreditFault::NoHttps);
        assert_eq!(wrong("javascript:alert(1)"), CreditFault::NoHttps);
        assert_eq!(
            wrong("https://a@b.org/?experiment_id=1&credit_token=2&survey_code=3"),
            CreditFault::NoHttps
        );
        assert_eq!(wrong(&format!("{sona}\"")), CreditFault::Characters);
        assert_eq!(wrong(&format!("{sona}#x")), CreditFault::Characters);
        assert_eq!(wrong("https://school.sona-systems.com/"), CreditFault::Field("experiment_id"));
        assert_eq!(
            wrong(&sona.replace("credit_token=9185d4", "credit_token=")),
            CreditFault::Field("credit_token")
        );
        assert_eq!(wrong(&sona.replace("&survey_code=XXXX", "")), CreditFault::Field("survey_code"));
        assert_eq!(wrong(&format!("{sona}&survey_code=2")), CreditFault::Field("survey_code"));
    }
}
