import { Told } from "../told";
import { useState } from "preact/hooks";
import { useUrl } from "../url_state";
import { useWords } from "../words";
import { CardTable, Scroll } from "../workbench/parts";
import { download } from "./shown";
import type { FeedLink, Tag } from "./watch_types";
import { useAnswer } from "./watch_store";

const shown = 400;  // rows at a time
const lookAgain = 2000;  // ms: registers change while nothing is stored

function csvOf(tags: Tag[]): string {
  const quoted = (field: string) => (/[",\n]/.test(field) ? `"${field.replace(/"/g, '""')}"` : field);
  const rows = tags.map((t) => [t.feed, t.axis, t.address, t.name, t.type, t.unit, t.scaling, t.meaning]);
  return [["feed", "axis", "address", "name", "type", "unit", "scaling", "meaning"], ...rows].map((row) => row.map(quoted).join(",")).join("\n") + "\n";
}

const columns = ["feed", "address", "tagName", "tagType", "tagNow", "tagUnit", "scaling"] as const;

/** Everything that SCADA systems can read, with what it is now. */
export function Scada() {
  const say = useWords();
  const [query, setUrl] = useUrl();
  const [text, setText] = useState("");
  const found = useAnswer<{ tags: Tag[]; links: FeedLink[] }>("watch/tags", {}, lookAgain);
  if (!found) return <p class="empty" role="status">{say("loading")}</p>;
  const axes = [...new Set(found.tags.map((t) => t.axis))].filter((axis) => axis !== "");
  const tags = found.tags.filter((t) => (!query.feed || t.feed === query.feed) && (!query.axis || t.axis === query.axis) &&
    `${t.address} ${t.name} ${t.meaning}`.toLowerCase().includes(text.toLowerCase()));
  const choice = (key: string, label: string, values: string[]) => (
    <label>{label} <select value={query[key] ?? ""} onChange={(e) => setUrl({ [key]: e.currentTarget.value })}>
      <option value="">{say("all")}</option>{values.map((value) => <option key={value} value={value}>{value}</option>)}
    </select></label>
  );
  return (
    <section class="scada">
      <h1>{say("view_scada")}</h1>
      {found.links.length === 0 ? <p class="quiet">{say("linksNone")}</p> : (
        <CardTable label={say("links")} heads={[say("links"), say("alarm_state"), say("clients"), say("behind")]}
          rows={found.links.map((link) => [link.name, <span class={link.connected ? "" : "moved"}>{link.connected ? "✓ " : "✗ "}<Told of={link} what="state" /></span>, link.clients, link.behind])} />
      )}
      <div class="filters">
        {choice("feed", say("feed"), [...new Set(found.tags.map((t) => t.feed))])}
        {axes.length > 1 && choice("axis", say("alarm_axis"), axes)}
        <label>{say("search")} <input type="search" value={text} onInput={(e) => setText(e.currentTarget.value)} /></label>
        <button onClick={() => download("tags.csv", new Blob([csvOf(tags)], { type: "text/csv" }))}>{say("tagsCsv", { count: tags.length })}</button>
      </div>
      <p class="quiet">{say("tagsText")}</p>
      <Scroll label={say("view_scada")}><table class="tags cards" role="table">
        <thead><tr role="row">{columns.map((column) => <th key={column} scope="col" role="columnheader">{say(column)}</th>)}</tr></thead>
        <tbody>{tags.slice(0, shown).map((tag) => (
          <tr key={`${tag.feed}${tag.address}${tag.name}`} role="row">
            <td role="cell">{tag.feed}</td><td role="cell" class="code">{tag.address.split("/").map((part, k) => (k === 0 ? part : <>/<wbr />{part}</>))}</td>
            <td role="cell" class="leads" lang="en">{tag.axis && <small>{tag.axis} · </small>}{tag.name}{tag.meaning && <small> · {tag.meaning}</small>}</td>
            <td role="cell" lang="en">{tag.type}</td><td role="cell" data-label={say("tagNow")}>{tag.value === "" ? "–" : tag.value}</td><td role="cell">{tag.unit}</td><td role="cell">{tag.scaling}</td>
          </tr>))}</tbody>
      </table></Scroll>
      {tags.length > shown && <p class="quiet">{say("tagsMore", { shown, count: tags.length })}</p>}
    </section>
  );
}
