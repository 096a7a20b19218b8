//! URIs of buffers and images: data URIs are decoded here, paths prepared for the resolver.

use base64::Engine;
use base64::alphabet::{STANDARD, URL_SAFE};
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

/// What a URI asks for.
#[derive(Debug, PartialEq)]
pub(crate) enum Uri {
    /// The bytes of a data URI.
    Data(Vec<u8>),
    /// A path, percent-decoded.
    File(String),
}

/// Understands a URI; the error is a cause.
pub(crate) fn parse(uri: &str) -> Result<Uri, String> {
    if let Some(rest) = uri.strip_prefix("data:") {
        let (head, body) = rest
            .split_once(',')
            .ok_or("is a data URI without a comma")?;
        let bytes = if head.to_ascii_lowercase().ends_with(";base64") {
            base64(body).ok_or("is a data URI whose base64 is broken")?
        } else {
            percent(body)
        };
        return Ok(Uri::Data(bytes));
    }
    if let Some(colon) = uri.find(':')
        && uri[..colon]
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    {
        return Err(format!(
            "has the scheme \"{}\"; only paths and data URIs are read",
            &uri[..colon]
        ));
    }
    if uri.is_empty() || uri.contains('\0') {
        return Err("is not a path".to_owned());
    }
    String::from_utf8(percent(uri))
        .map(Uri::File)
        .map_err(|_| "is not UTF-8 after percent-decoding".to_owned())
}

/// `%41` to `A`; anything that is not an escape stays.
fn percent(text: &str) -> Vec<u8> {
    percent_decode_str(text).collect()
}

/// RFC 4648 with or without padding, in either alphabet.
fn base64(text: &str) -> Option<Vec<u8>> {
    let options = GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::RequireNone)
        .with_decode_allow_trailing_bits(true);
    let alphabet = if text.contains(['-', '_']) {
        &URL_SAFE
    } else {
        &STANDARD
    };
    let engine = GeneralPurpose::new(alphabet, options);
    engine.decode(text.trim_end_matches('=')).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_gives_the_bytes_of_rfc_4648() {
        for (text, bytes) in [
            ("", &b""[..]),
            ("Zg==", b"f"),
            ("Zm8=", b"fo"),
            ("Zm9v", b"foo"),
            ("Zm9vYmFy", b"foobar"),
            ("Zm9vYg", b"foob"),
            ("-_-_", b"\xfb\xff\xbf"),
        ] {
            assert_eq!(base64(text).as_deref(), Some(bytes), "{text}");
        }
        assert_eq!(base64("Zm9vY"), None);
        assert_eq!(base64("Zm 9"), None);
    }

    #[test]
    fn schemes_are_refused_and_escapes_decoded() {
        assert!(parse("http://example.org/a.bin").is_err());
        let cause = "has the scheme \"file\"; only paths and data URIs are read";
        assert_eq!(parse("file:///etc/hosts"), Err(cause.to_owned()));
        assert!(parse("C:/x.bin").is_err());
        assert!(parse("").is_err());
        assert_eq!(
            parse("my%20file.bin"),
            Ok(Uri::File("my file.bin".to_owned()))
        );
        assert_eq!(parse("100%.bin"), Ok(Uri::File("100%.bin".to_owned())));
        assert_eq!(
            parse("data:application/octet-stream;base64,Zm9v"),
            Ok(Uri::Data(b"foo".to_vec()))
        );
        assert_eq!(parse("data:,a%62"), Ok(Uri::Data(b"ab".to_vec())));
    }
}
