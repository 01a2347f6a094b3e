//! `export`: a layer as an array.

use super::{Failure, find, open, read_blob, refuse_output};
use crate::cli::{Export, WhatToExport};
use plan_compiler::output::{self, ArrayFormat, What};

pub(super) fn run(args: &Export) -> Result<(), Failure> {
    let extension = args.output.extension().and_then(|extension| extension.to_str());
    let format = match extension.map(str::to_ascii_lowercase).as_deref() {
        Some("npy") => ArrayFormat::Npy,
        Some("csv") => ArrayFormat::Csv,
        _ => return Err(Failure::Usage("the output's name must end in .npy or .csv".into())),
    };
    let what = match args.what {
        WhatToExport::Cost => What::Cost,
        WhatToExport::Direction => What::Direction,
        WhatToExport::Blocked => What::Blocked,
        WhatToExport::Toll => What::Toll,
        WhatToExport::Limit => What::Limit,
        WhatToExport::Goal => What::Goal,
    };
    refuse_output(&args.output, &[&args.plans])?;
    let bytes = read_blob(&args.plans)?;
    let plan = open(&args.plans, &bytes)?;
    let (_, layer) = find(&plan, args.layer.as_ref())?;
    let write =
        |out: &mut dyn std::io::Write| output::write_array(out, format, what, plan.grid(), &layer);
    Ok(output::write_file(&args.output, write)?)
}
