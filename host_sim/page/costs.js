// What a step of a free body costs on each core, by the rows of bench/results/free.jsonl.
class Costs {
    static clocks = [16, 48, 168];  // MHz

    constructor(rows) { this.rows = rows; }

    // A table of one method; at this step in real time.
    table(way, seconds) {
        const keys = ['integrator', 'numbers', 'carry'];
        const rows = this.rows.filter(row => keys.every(key => row[key] === way[key]));
        const table = document.createElement('table');
        const line = (cells, tag) => {
            const row = table.appendChild(document.createElement('tr'));
            for (const cell of cells) row.appendChild(document.createElement(tag)).textContent = cell;
        };
        line(['core', 'a step', 'worst', ...Costs.clocks.map(clock => `${clock} MHz`)], 'th');
        const number = x => x === null ? '-' : Math.round(x).toLocaleString('en').replace(/,/g, ' ');
        for (const row of rows) {
            const share = clock => row.unit === 'cycles' ? Costs.percent(row.mean / (seconds * clock * 1e6)) : '-';
            const unit = row.unit === 'insn' ? ' insn' : '';
            line([row.core, number(row.mean) + unit, number(row.worst) + unit, ...Costs.clocks.map(share)], 'td');
        }
        return rows.length > 0 ? table : undefined;
    }
    static percent(share) { return share >= 0.1 ? `${Math.round(100 * share)} %` : `${(100 * share).toPrecision(2)} %`; }
}
