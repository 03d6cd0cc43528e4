(* The kinds `gap` and `sliver` of docs/certificates.md: an optimum between a dual and a support. *)

open Text
open Tree
open Ball
open Value
open Goal

type panel = { first : tree; last : tree; sigma : tree; regressors : tree list }

type problem = {
  panels : panel list;
  functional : tree list;
  place : string; (* the variable of the regressors *)
  parameter : side; (* of the problem *)
  named : string;
  lower : Q.t;
  upper : Q.t;
  mutable left : int; (* cells that all bisections share *)
}

let share = "share of a panel" (* no name of a certificate has blanks *)

(* x**0 is 1 here, wherever x has a value. *)
let with_unit_powers =
  replace (function Pow (a, b) when !constant b = Some Q.zero -> Some (Sum [ one; Prod [ zero; a ] ]) | _ -> None)

let read_within what names value =
  let t = with_unit_powers (get_tree what value) in
  Names.iter (fun s -> if not (List.mem s names) then no_symbols s) (symbols t);
  t

let problem_keys = [ "kind"; "variable"; "parameter"; "panels"; "functional"; "from"; "to"; "lower"; "upper"; "bits"; "cells" ]

(* The problem, and the values of the other keys *)
let read_problem keys value ~use =
  let values = get_keys "gap" (problem_keys @ keys) value in
  match values with
  | _ :: variable :: parameter :: panels :: functional :: first :: last :: lower :: upper :: bits :: cells :: others ->
      let bits = get_bits 20000 bits in
      let cells = get_integer "cells" 0 (most_cells bits) cells in
      at_precision bits (fun () ->
          let t = get_name "variable" variable and p = get_name "parameter" parameter in
          if t = p then refuse "variable, parameter: expected two names";
          let functional = List.map (read_within "functional" [ p ]) (get_list "functional" functional) in
          let read_panel v =
            match get_keys "panel" [ "measurement"; "from"; "to"; "sigma"; "H" ] v with
            | [ _; first; last; sigma; h ] ->
                let of_p what = read_within what [ p ] in
                let regressors = List.map (read_within "H" [ t; p ]) (get_list "H" h) in
                same_length "H" functional regressors;
                { first = of_p "from" first; last = of_p "to" last; sigma = of_p "sigma" sigma; regressors }
            | _ -> assert false
          in
          let panels = List.map read_panel (get_list "panels" panels) in
          if panels = [] || functional = [] then refuse "panels, functional: expected entries";
          let first = get_number "from" first and last = get_number "to" last in
          let lower = get_number "lower" lower and upper = get_number "upper" upper in
          let low = of_rational first in
          let parameter = { low; length = less (of_rational last) low; start = Z.zero; level = 0 } in
          use { panels; functional; place = t; parameter; named = p; lower; upper; left = cells_allowed cells } others)
  | _ -> assert false

(* A tree of the place and the parameter on a panel, as one of the share and the parameter *)
let on_panel problem panel =
  let place = Sum [ panel.first; Prod [ subtract panel.last panel.first; Sym share ] ] in
  replace (function Sym s when s = problem.place -> Some place | _ -> None)

let cell_of problem side = Map_of_names.(add problem.named problem.parameter (singleton share side))
let whole_side = { low = ball_zero; length = ball_one; start = Z.zero; level = 0 }

(* The ball of a tree on a cell, by itself and as mean value form *)
let ball_on cell t =
  let value balls s = match Map_of_names.find_opt s balls with Some x -> x | None -> no_symbols s in
  let balls = Map_of_names.map part_ball cell in
  match ball Whole (value balls) t with x when is_finite x -> Some (x, fun () -> mean_value_ball balls cell t) | _ -> None
  | exception No_value -> None

let is_below_one x = is_above (less ball_one x) && is_above (plus ball_one x)

(* |f| < 1 on the panel; f has a value there. *)
let check_below_one problem t =
  let settled cell =
    match ball_on cell t with
    | None -> false
    | Some (x, mean) -> is_below_one x || (match mean () with y -> is_below_one y | exception No_value -> false)
  in
  let counted cell =
    problem.left <- problem.left - 1;
    settled cell
  in
  bisect ~cells:problem.left ~names:[ share ] ~settled:counted (cell_of problem whole_side)

let ball_at problem x t =
  match ball_on (cell_of problem { whole_side with low = x; length = ball_zero }) t with
  | Some (y, _) -> y
  | None -> refuse "no value on the panel"

(* W with M W = P, by elimination with the pivot that is farthest from 0 *)
let rec solve rows =
  match rows with
  | [] -> []
  | _ ->
      let distance (row, _) = (size (List.hd row)).lo in
      let best = List.fold_left (fun m row -> greatest m (distance row)) nought rows in
      let rec pick before = function
        | row :: l when compare_ends (distance row) best = 0 -> (row, List.rev_append before l)
        | row :: l -> pick (row :: before) l
        | [] -> assert false
      in
      let (pivot, right), others = pick [] rows in
      let reduce (row, b) =
        let c = over (List.hd row) (List.hd pivot) in
        (List.map2 (fun x p -> less x (times c p)) (List.tl row) (List.tl pivot), less b (times c right))
      in
      let rest = solve (List.map reduce others) in
      let known = List.fold_left2 (fun s p x -> plus s (times p x)) ball_zero (List.tl pivot) rest in
      over (less right known) (List.hd pivot) :: rest

let check_panels problem =
  let is_positive t = match ball_at problem ball_zero t with x -> is_above x in
  let check p = shown "a panel without length, or a noise bound that is not > 0" (is_positive (subtract p.last p.first) && is_positive p.sigma) in
  List.iter check problem.panels

let over_sigma panel t = Prod [ t; Pow (panel.sigma, Num Q.minus_one) ]
let total = List.fold_left plus ball_zero

let check value =
  read_problem [ "dual"; "support" ] value ~use:(fun problem others ->
      match others with
      | [ dual; support ] ->
          let dual = List.map (get_number "dual") (get_list "dual" dual) in
          same_length "dual" problem.functional dual;
          check_panels problem;
          let read_place v =
            match get_list "support" v with
            | [ i; v ] ->
                let v = get_number "support" v in
                if Q.sign v < 0 || Q.gt v Q.one then refuse "support: expected a share from 0 to 1";
                (List.nth problem.panels (get_integer "support" 0 (List.length problem.panels - 1) i), of_rational v)
            | _ -> refuse "support: expected [panel, share]"
          in
          let support = List.map read_place (get_list "support" support) in
          same_length "support" problem.functional support;
          let check_panel p =
            let f = Sum (zero :: List.map2 (fun x h -> Prod [ Num x; h ]) dual p.regressors) in
            check_below_one problem (on_panel problem p (over_sigma p f))
          in
          List.iter check_panel problem.panels;
          let functional = List.map (ball_at problem ball_zero) problem.functional in
          let value = total (List.map2 (fun x p -> times (of_rational x) p) dual functional) in
          let is_least a b = sign_of (less b a).lo >= 0 in
          shown "the optimum is not between the bounds" (is_least (of_rational problem.lower) value);
          let column (p, v) = List.map (fun h -> ball_at problem v (on_panel problem p (over_sigma p h))) p.regressors in
          let columns = List.map column support in
          let rows = List.mapi (fun i p -> (List.map (fun c -> List.nth c i) columns, p)) functional in
          let weights = match solve rows with w -> w | exception No_value -> refuse "a linear system that may be singular" in
          shown "the optimum is not between the bounds" (is_least (total (List.map size weights)) (of_rational problem.upper))
      | _ -> assert false)
