//! TOML to values. Reading removes each key from its row, so the keys that remain are unknown.

use toml_edit::{DocumentMut, InlineTable, Item, Table as Keys, Value};

use crate::{Board, Equipment, Machine, Memory, Region, State, Table};

/// Reads the whole file. An error names the row and the key.
pub(crate) fn table(text: &str) -> Result<Table, String> {
    let mut document: DocumentMut = text.parse().map_err(|error| format!("{error}"))?;
    let boards = rows(document.as_table_mut(), "board", board)?;
    let machines = rows(document.as_table_mut(), "machine", machine)?;
    nothing_left(document.as_table())?;
    Ok(Table { boards, machines })
}

fn rows<T>(
    document: &mut Keys,
    kind: &str,
    read: impl Fn(&str, &mut Keys) -> Result<T, String>,
) -> Result<Vec<T>, String> {
    let Some(Item::Table(mut table)) = document.remove(kind) else {
        return Err(format!("there is no [{kind}.NAME]"));
    };
    let mut rows = Vec::new();
    for (name, item) in table.iter_mut() {
        let name = name.get();
        let place = |problem: String| format!("[{kind}.{name}]: {problem}");
        let keys = item.as_table_mut().ok_or_else(|| place("not a table".into()))?;
        rows.push(read(name, keys).map_err(place)?);
        nothing_left(keys).map_err(place)?;
    }
    Ok(rows)
}

fn board(name: &str, keys: &mut Keys) -> Result<Board, String> {
    let memory = memory(keys)?;
    let erase_bytes = kib(keys, "erase_kib")?;
    let slot = memory.plans.bytes / 2;
    let address = memory.plans.address as usize;
    let is_whole = slot.is_multiple_of(erase_bytes) && address.is_multiple_of(erase_bytes);
    if erase_bytes == 0 || !is_whole {
        return Err("the two slots of `plans` are not whole erase units".into());
    }
    // Intel HEX addresses 64 KiB at a time; an aligned region keeps its records whole.
    if !address.is_multiple_of(0x1_0000) {
        return Err("`plans` does not start at a multiple of 64 KiB".into());
    }
    let uf2_family = match keys.remove("uf2_family") {
        Some(item) => Some(
            item.as_integer()
                .and_then(|family| u32::try_from(family).ok())
                .ok_or("`uf2_family` is not a 32-bit integer")?,
        ),
        None => None,
    };
    let state = match text(keys, "state")?.as_str() {
        "planned" => State::Planned,
        "built" => State::Built,
        "tried" => State::Tried,
        other => return Err(format!("`state` is \"{other}\"")),
    };
    Ok(Board {
        name: name.to_owned(),
        chip: text(keys, "chip")?,
        target: text(keys, "target")?,
        memory,
        erase_bytes,
        uf2_family,
        has: equipment(keys)?,
        state,
    })
}

fn equipment(keys: &mut Keys) -> Result<Vec<Equipment>, String> {
    let item = keys.remove("has");
    let has = item.as_ref().and_then(Item::as_array).ok_or("`has` is not a list")?;
    let find = |value: &Value| {
        let name = value.as_str()?;
        Equipment::ALL.into_iter().find(|equipment| equipment.name() == name)
    };
    has.iter().map(|value| find(value).ok_or(format!("`has` has {value}"))).collect()
}

fn machine(name: &str, keys: &mut Keys) -> Result<Machine, String> {
    Ok(Machine { name: name.to_owned(), target: text(keys, "target")?, memory: memory(keys)? })
}

fn memory(keys: &mut Keys) -> Result<Memory, String> {
    let memory = Memory {
        program: region(keys, "program")?,
        plans: region(keys, "plans")?,
        ram: region(keys, "ram")?,
        stack_bytes: kib(keys, "stack_kib")?,
    };
    if memory.stack_bytes >= memory.ram.bytes {
        return Err("`stack_kib` leaves nothing of `ram`".into());
    }
    let regions = memory.regions();
    for (index, (name, region)) in regions.iter().enumerate() {
        if region.range().end > 1 << 32 {
            return Err(format!("`{name}` ends beyond 32 bits"));
        }
        for (other, apart) in &regions[..index] {
            if region.range().start < apart.range().end && apart.range().start < region.range().end
            {
                return Err(format!("`{other}` and `{name}` overlap"));
            }
        }
    }
    Ok(memory)
}

fn region(keys: &mut Keys, key: &str) -> Result<Region, String> {
    let Some(Item::Value(Value::InlineTable(mut inner))) = keys.remove(key) else {
        return Err(format!("`{key}` is not {{ address, kib }}"));
    };
    let region = |inner: &mut InlineTable| {
        let address = u32::try_from(inner.remove("address")?.as_integer()?).ok()?;
        let kib = u32::try_from(inner.remove("kib")?.as_integer()?).ok()?;
        (kib > 0 && inner.is_empty()).then_some(Region { address, bytes: (kib as usize) << 10 })
    };
    region(&mut inner).ok_or_else(|| format!("`{key}` is not {{ address, kib }}"))
}

fn kib(keys: &mut Keys, key: &str) -> Result<usize, String> {
    let kib = keys.remove(key).and_then(|item| item.as_integer());
    let kib = kib.and_then(|kib| u32::try_from(kib).ok());
    kib.map(|kib| (kib as usize) << 10).ok_or_else(|| format!("`{key}` is not a number of KiB"))
}

fn text(keys: &mut Keys, key: &str) -> Result<String, String> {
    let item = keys.remove(key);
    let text = item.as_ref().and_then(|item| item.as_str());
    text.map(str::to_owned).ok_or_else(|| format!("`{key}` is not a text"))
}

fn nothing_left(keys: &Keys) -> Result<(), String> {
    match keys.iter().next() {
        Some((key, _)) => Err(format!("unknown key `{key}`")),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROVER: &str = "[board.rover]\n\
        chip = \"C\"\n\
        target = \"T\"\n\
        program = { address = 0x0, kib = 64 }\n\
        plans = { address = 0x1_0000, kib = 256 }\n\
        erase_kib = 64\n\
        ram = { address = 0x2000_0000, kib = 64 }\n\
        stack_kib = 16\n\
        has = [\"compass\", \"outputs\"]\n\
        uf2_family = 7\n\
        state = \"tried\"\n\
        [machine.emulated]\n\
        target = \"T\"\n\
        program = { address = 0x0, kib = 64 }\n\
        plans = { address = 0x1_0000, kib = 64 }\n\
        ram = { address = 0x2000_0000, kib = 64 }\n\
        stack_kib = 16\n";

    #[test]
    fn a_row_is_read_key_by_key() {
        let table = table(ROVER).unwrap();
        let [board] = &table.boards[..] else { panic!("{table:?}") };
        assert_eq!((&*board.name, &*board.chip, &*board.target), ("rover", "C", "T"));
        assert_eq!(board.memory.plans, Region { address: 0x1_0000, bytes: 256 << 10 });
        assert_eq!((board.erase_bytes, board.slot_bytes()), (64 << 10, 128 << 10));
        assert_eq!((board.uf2_family, board.state), (Some(7), State::Tried));
        assert_eq!(board.has, [Equipment::Compass, Equipment::Outputs]);
        assert_eq!(table.machines[0].memory.ram.range(), 0x2000_0000..0x2001_0000);
    }

    #[test]
    fn every_mistake_is_reported_by_name() {
        for (right, wrong, problem) in [
            ("chip = \"C\"\n", "", "[board.rover]: `chip` is not a text"),
            ("state = \"tried\"", "state = \"done\"", "`state` is \"done\""),
            ("uf2_family = 7", "uf2_family = -7", "`uf2_family` is not"),
            ("uf2_family = 7", "uf2_famly = 7", "unknown key `uf2_famly`"),
            ("0x0, kib = 64", "0x0, kib = 65", "`program` and `plans` overlap"),
            ("0x1_0000, kib = 256", "0x1_0000, kib = 192", "not whole erase units"),
            ("0x1_0000, kib = 256", "0x1_0000, kib = 256, bank = 2", "`plans` is not"),
            ("has = [\"compass\"", "has = [\"lidar\"", "`has` has \"lidar\""),
            ("has = [", "hass = [", "`has` is not a list"),
            ("erase_kib = 64\n", "erase_kib = 0\n", "not whole erase units"),
            ("0x2000_0000, kib = 64", "0xFFFF_F000, kib = 64", "ends beyond 32 bits"),
            ("stack_kib = 16", "stack_kib = 64", "leaves nothing of `ram`"),
            ("[machine.emulated]", "[machines.emulated]", "there is no [machine.NAME]"),
        ] {
            let text = ROVER.replacen(right, wrong, 1);
            assert_ne!(text, ROVER, "{right}");
            let error = table(&text).unwrap_err();
            assert!(error.contains(problem), "{wrong}: {error}");
        }
        let text = ROVER
            .replace("erase_kib = 64", "erase_kib = 4")
            .replace("0x1_0000, kib = 256", "0x1_1000, kib = 256");
        assert!(table(&text).unwrap_err().contains("64 KiB"));
    }

    #[test]
    fn the_table_of_the_project_is_sound() {
        let table = table(include_str!("../boards.toml")).unwrap();
        assert!(table.boards.len() >= 4 && table.machines.len() >= 2, "{table:?}");
    }
}
