//! The receipt of a verification: what was verified, on which premises, and what was proved of each move.

use serde::Serialize;
use serde_json::{Map, Value};
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{ObjectBuilder, RefBuilder, Schema};
use utoipa::{IntoParams, PartialSchema, ToSchema};

use super::report::{FindingCount, NotChecked, VerifyReport};
use super::{Lines, Path, Rapids, Verification};
use crate::http::ENGINE_VERSION;
use crate::http::decode::query::{FromQuery, Parameters};
use crate::http::dto::answer::{PathMembers, joined};
use crate::http::dto::point::Point;
use crate::http::dto::program_reading::ReadPremises;
use crate::http::error::{ApiError, Code, FieldCode, FieldError};
use crate::http::pointer::Pointer;
use crate::receipt::{SigningKey, digest, digest_of, digest_of_tree};
use toolpathd_core::operations::verification::{self as core, Verdict, Worst};

/// The form of receipts that this version writes.
pub const SCHEMA: &str = "toolpathd-receipt-1";

/// The most moves of a receipt. One takes some 150 bytes of JSON.
const MOST_MOVES: usize = 200_000;

/// Members of a request that are digested together, with the name of their digest.
pub const DIGESTED: [(&str, &[&str]); 5] = [
    ("part", &["surface", "allowance_mm", "region", "top_z_mm", "floor_z_mm"]),
    ("tools", &["tool", "tools"]),
    ("stock", &["stock"]),
    ("fixtures", &["fixtures"]),
    ("travel", &["travel"]),
];

/// Whether the answer holds a receipt.
#[derive(Debug, Clone, Copy, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct VerifyQuery {
    /// Whether the JSON answer holds a receipt, which tells the premises, digests of all that was verified,
    /// and the bound of each move. Default: `false`.
    #[param(value_type = Option<bool>)]
    pub receipt: bool,
}

impl FromQuery for VerifyQuery {
    const NAMES: &'static [&'static str] = &["receipt"];

    fn read(sent: &Parameters) -> Result<Self, String> {
        Ok(Self { receipt: sent.flag("receipt")?.unwrap_or(false) })
    }
}

/// The members of an answer beside its report.
#[derive(Serialize)]
pub struct VerifyMembers {
    #[serde(flatten)]
    pub path: PathMembers,
    /// Present with `?receipt=true`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub receipt: Option<Receipt>,
}

impl PartialSchema for VerifyMembers {
    fn schema() -> RefOr<Schema> {
        let receipt = RefBuilder::new()
            .ref_location_from_schema_name(Receipt::name())
            .description(Some("Present with `?receipt=true`."));
        let own = ObjectBuilder::new().property("receipt", receipt.build()).build();
        joined([own.into(), PathMembers::schema()])
    }
}

impl ToSchema for VerifyMembers {
    fn schemas(schemas: &mut Vec<(String, RefOr<Schema>)>) {
        schemas.push((Receipt::name().into_owned(), Receipt::schema()));
        Receipt::schemas(schemas);
        PathMembers::schemas(schemas);
    }
}

/// What a receipt needs besides the verification.
#[derive(Debug)]
pub struct Asked {
    pub digests: Digests,
    pub key: Option<SigningKey>,
}

/// What was verified, on which premises, and what was proved of each move. A receipt belongs to the program,
/// the part, the tools, the stock, the fixtures and the travel of its digests. `toolpathd check` proves all
/// of it anew.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct Receipt {
    /// The form of the receipt: `toolpathd-receipt-1`.
    schema: &'static str,
    /// Version of the service that has verified.
    engine_version: &'static str,
    /// What the receipt is of.
    digests: Digests,
    /// On what its statements depend.
    premises: Premises,
    /// The verdict of the report.
    verdict: Verdict,
    /// What is proved of all moves together.
    bounds: Bounds,
    /// How many findings there are of each kind.
    counts: Vec<FindingCount>,
    /// What was not verified.
    not_checked: Vec<NotChecked>,
    /// The moves in the order of the program. Empty without a part.
    moves: Vec<MoveBound>,
    /// Digest of this receipt without `digest` and `signature`: SHA-256 of its canonical JSON (RFC 8785), in
    /// hexadecimal digits.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(required)]
    digest: Option<String>,
    /// Absent where the service has no key.
    #[serde(skip_serializing_if = "Option::is_none")]
    signature: Option<ReceiptSignature>,
}

/// Digests: SHA-256 in hexadecimal digits. That of a program is of its text; the others are of the members of
/// the request in canonical JSON (RFC 8785), without members that are `null`.
#[derive(Debug, Clone, Default, Serialize, ToSchema)]
#[schema(as = ReceiptDigests)]
pub struct Digests {
    /// Of the text in `nc`, or of `toolpath` in canonical JSON.
    program: String,
    /// Of an object with `surface`, `allowance_mm`, `region`, `top_z_mm` and `floor_z_mm`, as far as they
    /// were sent.
    part: String,
    /// Of an object with `tool` or `tools`.
    tools: String,
    /// Of an object with `stock`.
    stock: String,
    /// Of an object with `fixtures`.
    fixtures: String,
    /// Of an object with `travel`.
    travel: String,
}

/// On what the bounds depend besides the digested data.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = ReceiptPremises)]
pub struct Premises {
    /// How the text was read. Absent for a `toolpath`.
    #[serde(skip_serializing_if = "Option::is_none")]
    program: Option<ReadPremises>,
    /// How deep the cutter may enter the part and, on a rapid, the stock, in mm.
    tolerance_mm: f64,
    /// How far the control may leave the path, in mm.
    control_tolerance_mm: f64,
    /// How far arcs of two radii were moved at most, in mm. It counts as the control's.
    arcs_moved_mm: f64,
    /// The least distance from fixtures, and of shank and holder from all else, in mm.
    clearance_mm: f64,
    /// How much may stand above the part at the end, in mm. Absent where anything may.
    #[serde(skip_serializing_if = "Option::is_none")]
    allowed_excess_mm: Option<f64>,
    /// Largest size of a cell of the stock, in mm. Absent where the service has chosen it.
    #[serde(skip_serializing_if = "Option::is_none")]
    cell_mm: Option<f64>,
    /// How the control runs a rapid.
    rapids: Rapids,
}

/// The proved bounds of the report.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = ReceiptBounds)]
struct Bounds {
    /// How deep the cutter enters the part at most, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    gouge_mm: Option<f64>,
    /// What stands above the part at most, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    excess_mm: Option<f64>,
    /// What stands at the walls of a pocket at most, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    wall_excess_mm: Option<f64>,
    /// Area of the floor that is not cut, in mm2.
    #[serde(skip_serializing_if = "Option::is_none")]
    uncut_area_mm2: Option<f64>,
    /// How deep a rapid enters the stock at most, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    rapid_depth_mm: Option<f64>,
    /// Least distance of shank and holder from stock and part, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    holder_clearance_mm: Option<f64>,
    /// Least distance of the tool from fixtures, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    fixture_clearance_mm: Option<f64>,
}

/// What is proved of one move.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = ReceiptMove)]
struct MoveBound {
    /// Number of the line of the program, counted from 1. Absent for a toolpath.
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<u32>,
    /// Number of the pass, counted from 0.
    pass: usize,
    /// Number of the move in the pass, counted from 0.
    #[serde(rename = "move")]
    index: usize,
    /// How deep the cutter enters the part at most, over the whole of the move, in mm.
    gouge_mm: f64,
    /// The witness: how deep the place `at` lies in the cutter, in mm. Absent where the cutter enters
    /// nowhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    found_mm: Option<f64>,
    /// The place of the witness, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    at: Option<Point>,
}

/// A signature of the receipt: Ed25519 (RFC 8032) of `toolpathd receipt 1`, a line feed, and the digest.
#[derive(Debug, Clone, Serialize, ToSchema)]
struct ReceiptSignature {
    /// `ed25519`.
    algorithm: &'static str,
    /// The public key: 32 bytes in base64.
    public_key: String,
    /// The signature: 64 bytes in base64.
    value: String,
}

impl Digests {
    /// The digests of the body of a request.
    ///
    /// # Errors
    /// When the body is no object of JSON.
    pub fn of(body: &[u8]) -> Result<Self, ApiError> {
        let unread = |error| ApiError::new(Code::InternalError, format!("digesting the body: {error}"));
        let mut body: Map<String, Value> = serde_json::from_slice(body).map_err(unread)?;
        let program = match body.remove("nc") {
            Some(Value::String(text)) => digest(text.as_bytes()),
            _ => digest_of_tree(body.remove("toolpath").unwrap_or_default()).map_err(unread)?,
        };
        // The members are taken out, because copies of a large part take much memory.
        let mut of = |names: &[&str]| {
            let sent = names.iter().filter_map(|name| body.remove_entry(*name)).collect();
            digest_of_tree(Value::Object(sent)).map_err(unread)
        };
        let [part, tools, stock, fixtures, travel] = DIGESTED.map(|(_, names)| of(names));
        Ok(Self { program, part: part?, tools: tools?, stock: stock?, fixtures: fixtures?, travel: travel? })
    }
}

impl Premises {
    /// The premises of a verification, but how far its arcs are moved.
    ///
    /// # Errors
    /// When the dialect is not read.
    pub fn of(job: &Verification) -> Result<Self, ApiError> {
        let program = match &job.path {
            Path::Program(reading) => Some(reading.premises()?),
            Path::Toolpath { .. } => None,
        };
        Ok(Self {
            program,
            tolerance_mm: job.tolerance_mm,
            control_tolerance_mm: job.control_tolerance_mm,
            arcs_moved_mm: 0.0,
            clearance_mm: job.clearance_mm,
            allowed_excess_mm: job.allowed_excess_mm,
            cell_mm: job.cell_mm,
            rapids: Rapids::Straight,
        })
    }

    /// The same premises, with what is known once the program has been read.
    pub fn read(self, arcs_moved_mm: f64, rapids: core::Rapids) -> Self {
        let rapids = match rapids {
            core::Rapids::Straight => Rapids::Straight,
            core::Rapids::DogLeg => Rapids::DogLeg,
        };
        Self { arcs_moved_mm, rapids, ..self }
    }
}

impl Receipt {
    /// # Errors
    /// `limit_exceeded` for too many moves.
    pub fn new(
        asked: Asked,
        premises: Premises,
        report: &VerifyReport,
        found: &core::Report,
        lines: Option<&Lines<'_>>,
    ) -> Result<Self, ApiError> {
        let Asked { digests, key } = asked;
        let mut receipt = Self {
            schema: SCHEMA,
            engine_version: ENGINE_VERSION,
            digests,
            premises,
            verdict: found.verdict,
            bounds: Bounds {
                gouge_mm: found.gouge.map(|worst| worst.bound_mm),
                excess_mm: found.excess.map(|worst| worst.bound_mm),
                wall_excess_mm: found.wall_excess.map(|worst| worst.bound_mm),
                uncut_area_mm2: found.uncut_area_mm2,
                rapid_depth_mm: found.material.as_ref().map(|material| material.rapid_depth.bound_mm),
                holder_clearance_mm: found.holder_clearance.map(|worst| worst.bound_mm),
                fixture_clearance_mm: found.fixture_clearance.map(|worst| worst.bound_mm),
            },
            counts: report.counts.clone(),
            not_checked: report.not_checked.clone(),
            moves: moves(&found.gouges_of_moves, lines),
            digest: None,
            signature: None,
        };
        let unwritten = |error| ApiError::new(Code::InternalError, format!("digesting a receipt: {error}"));
        let digest = digest_of(&receipt).map_err(unwritten)?;
        receipt.signature = key.map(|key| ReceiptSignature {
            algorithm: "ed25519",
            public_key: key.public().to_string(),
            value: key.sign(&digest),
        });
        receipt.digest = Some(digest);
        Ok(receipt)
    }

    /// Refuses a toolpath with too many moves.
    ///
    /// # Errors
    /// `limit_exceeded`.
    pub fn check_moves(n_moves: usize, is_program: bool) -> Result<(), ApiError> {
        if n_moves <= MOST_MOVES {
            return Ok(());
        }
        let detail = format!(
            "a receipt has at most {MOST_MOVES} moves, and there are {n_moves}; split the program, or leave \
             out `receipt=true`"
        );
        let at = Pointer::root().field(if is_program { "nc" } else { "toolpath" });
        Err(ApiError::invalid(vec![FieldError::new(&at, FieldCode::LimitExceeded, detail)]))
    }
}

/// The bounds of the moves. The place where a pass starts counts to its first move.
fn moves(found: &[Worst], lines: Option<&Lines<'_>>) -> Vec<MoveBound> {
    let number = |worst: &Worst| worst.place.map(|place| place.number);
    let of_moves = found.chunk_by(|one, other| number(one) == number(other));
    let deepest = of_moves.filter_map(|own| {
        let deepest =
            own.iter().reduce(|one, other| if other.bound_mm > one.bound_mm { other } else { one })?;
        let place = deepest.place?;
        Some(MoveBound {
            line: lines.and_then(|lines| lines.of_moves.get(place.number).copied()),
            pass: place.pass,
            index: place.index,
            gouge_mm: deepest.bound_mm,
            found_mm: deepest.found_mm,
            at: deepest.at.map(Point::from),
        })
    });
    deepest.collect()
}
